# Asymmetry found against asymmetry planted.
name = 'planted'; wide = 640; high = 520
load begin
set title 'Asymmetry of made-up faces: found in scans against planted'
set xlabel 'planted: least mean gap to the mirror image, mm'
set ylabel 'found in a scan, mm'
set key bottom right
set xrange [0:*]
set yrange [0:*]
set offsets 0, 0.1, 0.1, 0
plot dir . '/scans.csv' using 3:4 with points ls 6 title 'first: plane of the canonical frame', \
     dir . '/scans.csv' using 3:5 with points ls 1 title 'final: plane corrected', \
     x with lines ls 9 dt 2 title 'equal'
