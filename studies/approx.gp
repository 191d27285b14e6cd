# The general triangulation against the exact overlay.
name = 'difference'; wide = 800; high = 480
load begin
set title 'Disparity over the general triangulation against the exact volume'
set logscale xy
set format x '10^{%T}'
set xlabel 'N, points in each mesh'
set ylabel 'mean relative difference, %'
set key outside right
plot for [k = 1:5] dir . '/approx.csv' \
    using (stringcolumn(1) eq word('apart crossing same faces noisy', k) ? $2 : NaN):7 \
    with linespoints ls k title word('apart crossing same faces noisy', k)
