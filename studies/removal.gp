# Which removals hurt.
name = 'kinds'; wide = 1000; high = 440
load begin
set multiplot layout 1,3 title 'Error after removal from 1,000 points, mean of six functions'
set xlabel 'points removed, %'
set xrange [-3:78]
set key top left
kinds = 'random blobs ridges flats hull'
set ylabel 'mean |error|, % of the function''s range'
set yrange [0.03:60]
set logscale y
set title 'all triangles, the whole square'
plot for [k = 1:5] dir . '/mean.csv' using (stringcolumn(1) eq word(kinds, k) ? $2 : NaN):3 \
    with linespoints ls k title word(kinds, k)
set title 'without bridging triangles'
plot for [k = 1:5] dir . '/mean.csv' using (stringcolumn(1) eq word(kinds, k) ? $2 : NaN):4 \
    with linespoints ls k title word(kinds, k)
unset logscale
set title 'what is then still measured'
set ylabel 'share of the square'
set yrange [0:1.05]
set key bottom left
plot for [k = 1:5] dir . '/mean.csv' using (stringcolumn(1) eq word(kinds, k) ? $2 : NaN):5 \
    with linespoints ls k title word(kinds, k)
unset multiplot
