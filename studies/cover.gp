# Faces with parts missing.
name = 'truth'; wide = 800; high = 460
load begin
set title 'A scan with blobs cut out, against the true face: mean |gap|, median and 5-95 % of people'
set xlabel 'points removed, %'
set ylabel 'mean |gap| to the true face, mm'
set yrange [0:*]
set xrange [-4:98]
set key top left
plot dir . '/truth.csv' using ($1 - 0.5):3:4:5 with yerrorbars ls 2 title 'all triangles', \
     dir . '/truth.csv' using ($1 + 0.5):7:8:9 with yerrorbars ls 1 title 'without those that bridge holes'

name = 'decisions'; wide = 960; high = 440
load begin
set multiplot layout 1,2 title 'Decisions by the daemon''s defaults, made-up faces'
set xlabel 'points removed from the probe, %'
set ylabel 'share of comparisons, %'
set xrange [-4:98]
set yrange [-3:128]
set ytics 0,20,100
set key top left
set title 'mated comparisons'
plot dir . '/madeup.csv' using 1:4 with linespoints ls 3 title 'match', \
     dir . '/madeup.csv' using 1:5 with linespoints ls 2 title 'non-match', \
     dir . '/madeup.csv' using 1:6 with linespoints ls 6 title 'inconclusive'
set title 'non-mated comparisons'
plot dir . '/madeup.csv' using 1:8 with linespoints ls 3 title 'match', \
     dir . '/madeup.csv' using 1:9 with linespoints ls 2 title 'non-match', \
     dir . '/madeup.csv' using 1:10 with linespoints ls 6 title 'inconclusive'
unset multiplot

name = 'area'; wide = 960; high = 440
load begin
# The made-up faces, and the scans where --faces gave some.
sources = system(sprintf("cd '%s' && ls madeup-area.csv scans-area.csv 2>/dev/null", dir))
titles = '"made-up faces" scans'
most = 0
do for [k = 1:words(sources)] {
    stats dir . '/' . word(sources, k) using 7 nooutput
    most = STATS_max > most ? STATS_max : most
}
set multiplot layout 1,2 title 'By the threshold alone, against the share of the template''s area that was covered'
set xlabel 'share of the area covered (middle of the bin)'
set arrow from 0.3, graph 0 to 0.3, graph 1 nohead lc rgb '#666666' dt 2
set xrange [0:1]
set key bottom right
set ylabel 'match, %'
set yrange [0:105]
set title 'mated comparisons (dashed: below, inconclusive)'
plot for [k = 1:words(sources)] dir . '/' . word(sources, k) using (($1 + $2) / 2):4 \
         with linespoints ls 3 * k - 2 title word(titles, k)
set title 'non-mated comparisons'
set key top right
set yrange [0:most > 0 ? 1.1 * most : 1]
plot for [k = 1:words(sources)] dir . '/' . word(sources, k) using (($1 + $2) / 2):7 \
         with linespoints ls 3 * k - 1 title word(titles, k)
unset multiplot
