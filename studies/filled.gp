# Restored points.
name = 'filled'; wide = 960; high = 440
load begin
set multiplot layout 1,2 title 'Restored points against the true face, by the size of the hole'
set xlabel 'diameter of a circle of the hole''s area, mm'
set logscale xy
set xrange [4:70]
set xtics (5, 7, 10, 14, 20, 28, 40, 56)
set yrange [0.1:30]
set key top left
kinds = '"3000 points; round" "20000 points; round" "3000 points; 4 : 1"'
set ylabel 'mm'
set title 'root mean square'
plot for [k = 1:3] dir . '/filled.csv' using (stringcolumn(1) eq word(kinds, k) ? $2 : NaN):6 \
    with linespoints ls k title word(kinds, k)
set title '95 % of the points are below'
plot for [k = 1:3] dir . '/filled.csv' using (stringcolumn(1) eq word(kinds, k) ? $2 : NaN):8 \
    with linespoints ls k title word(kinds, k)
unset multiplot
