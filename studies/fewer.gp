# Simplification.
name = 'curves'; wide = 1000; high = 460
load begin
set multiplot layout 1,2 title 'Points taken out one by one, the least needed first (3,000 points)'
set logscale xy
set format y '%g'
set xlabel 'points kept, %'
set xrange [2.5:110]
set key bottom left
names = system(sprintf("cut -d, -f1 '%s/curves.csv' | sed 1d | uniq | tr ' ' '_'", dir))
set title 'by the largest gap'
set ylabel 'largest gap, % of the surface''s range'
plot for [k = 1:words(names)] dir . '/curves.csv' \
    using (system("echo '" . stringcolumn(1) . "' | tr ' ' '_'") eq word(names, k) && $3 > 0 ? $2 : NaN):3 \
    with linespoints ls k title system("echo '" . word(names, k) . "' | tr _ ' '")
set title 'by the volume'
set ylabel 'mean gap (disparity), % of the surface''s range'
plot for [k = 1:words(names)] dir . '/curves.csv' \
    using (system("echo '" . stringcolumn(1) . "' | tr ' ' '_'") eq word(names, k) && $6 > 0 ? $2 : NaN):6 \
    with linespoints ls k title system("echo '" . word(names, k) . "' | tr _ ' '")
unset multiplot
