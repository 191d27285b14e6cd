# A lower bound of the minimal disparity.
file = dir . '/bounds.csv'
set datafile separator ','
stats file using 5 skip 1 nooutput
radii = 6
pairs = int(STATS_records / radii)
mated(i) = system(sprintf("sed -n '%dp' '%s' | awk -F, '{ print $1 == $2 }'", 2 + radii * i, file)) + 0

name = 'radius'; wide = 1000; high = 460
load begin
set multiplot layout 1,2
set logscale x
set xrange [0.2:30]
set xlabel 'poses within so many mm, and 1/80 rad, of the reported minimum'
set ylabel 'proved lower bound / reported minimum'
set yrange [0:1.02]
set key bottom left
set title 'the frozen measure: bound by radius'
plot for [i = 0:pairs - 1] file using 5:9 every ::(1 + radii * i)::(radii * (i + 1)) \
         with linespoints ls (mated(i) ? 1 : 2) notitle, \
     NaN with linespoints ls 1 title 'mated', NaN with linespoints ls 2 title 'non-mated'
set ylabel 'measure / frozen measure, at random poses'
set yrange [*:*]
set key top left
set title 'how far the frozen measure is the measure: not proved'
sampled = dir . '/sampled.csv'
plot sampled using ($4 * (stringcolumn(1) eq stringcolumn(2) ? 0.96 : 1.04)):9:8:10 every ::1 with yerrorbars \
         lc rgb '#b0b0b0' pt 0 title 'the least to the largest', \
     sampled using (stringcolumn(1) eq stringcolumn(2) ? 0.96 * $4 : NaN):9 every ::1 with points ls 1 title 'mated, median', \
     sampled using (stringcolumn(1) ne stringcolumn(2) ? 1.04 * $4 : NaN):9 every ::1 with points ls 2 title 'non-mated, median'
unset multiplot

name = 'boxes'; wide = 1000; high = 460
load begin
steps = dir . '/steps.csv'
radius = '0.25 0.5 1 2 5 24'
who = system(sprintf("sed -n '2p' '%s' | cut -d, -f1,2,3", file))
last = system(sprintf("tail -n 1 '%s' | cut -d, -f1,2,3", file))
set multiplot layout 1,2
set logscale x
set xlabel 'boxes bounded'
set ylabel 'proved lower bound / reported minimum'
set yrange [0:1.02]
set key bottom right title 'within, mm'
set title 'a mated pair'
plot for [k = 1:words(radius)] steps \
    using (stringcolumn(1) . ',' . stringcolumn(2) . ',' . stringcolumn(3) eq who && $4 == word(radius, k) + 0 ? $5 : NaN):6 \
    every ::1 with linespoints ls k title word(radius, k)
set title 'a non-mated pair'
plot for [k = 1:words(radius)] steps \
    using (stringcolumn(1) . ',' . stringcolumn(2) . ',' . stringcolumn(3) eq last && $4 == word(radius, k) + 0 ? $5 : NaN):6 \
    every ::1 with linespoints ls k title word(radius, k)
unset multiplot
