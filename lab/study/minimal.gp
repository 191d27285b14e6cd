# The minimal disparity against brute force.
name = 'ratio'; wide = 1000; high = 440
load begin
set multiplot layout 1,2 title 'Above the best known minimum'
curve = dir . '/curve.csv'
file = dir . '/pairs.csv'
set ylabel 'share of the pairs'
set yrange [0:1.02]
set key bottom right
set xlabel 'production / best known - 1, %'
set xrange [0:3]
set arrow from 1, graph 0 to 1, graph 1 nohead lc rgb '#666666' dt 2
set arrow from 2, graph 0 to 2, graph 1 nohead lc rgb '#666666' dt 2
set title 'what production reports (dashed: 1 and 2 %)'
plot curve using (stringcolumn(1) eq 'mated' ? 100 * ($3 - 1) : NaN):2 with lines ls 1 title 'mated', \
     curve using (stringcolumn(1) eq 'non-mated' ? 100 * ($3 - 1) : NaN):2 with lines ls 2 title 'non-mated'
unset arrow
set xrange [0:*]
set xlabel 'alignment / best known - 1, %'
set title 'the measure at the pose of the score'
plot curve using (stringcolumn(1) eq 'mated' ? 100 * ($4 - 1) : NaN):2 with lines ls 1 title 'mated', \
     curve using (stringcolumn(1) eq 'non-mated' ? 100 * ($4 - 1) : NaN):2 with lines ls 2 title 'non-mated'
unset multiplot

name = 'moves'; wide = 1000; high = 440
load begin
set multiplot layout 1,2 title 'From the alignment to the best known minimum'
set key top left
set xlabel 'turn, degrees'
set ylabel 'shift, mm'
set xrange [0:*]
set yrange [0:*]
plot file using ($4 == 0 ? $10 : NaN):11 with points ls 2 title 'non-mated', \
     file using ($4 == 1 ? $10 : NaN):11 with points ls 1 title 'mated'
set ylabel 'common area there / at the alignment'
set yrange [0.94:*]
set key top right
plot file using ($4 == 0 ? $10 : NaN):12 with points ls 2 title 'non-mated', \
     file using ($4 == 1 ? $10 : NaN):12 with points ls 1 title 'mated', \
     0.95 with lines ls 6 dt 2 title "the least allowed"
unset multiplot
