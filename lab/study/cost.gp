# Tables 2 to 4 and the growth of each stage.
stage = '"triangulation" "spanning tree" "stored template: load" "location" "interpolation" \
    "general triangulation" "measure"' # the columns from the second on
name = 'growth'; wide = 900; high = 560
load begin
set title 'Processor time of each stage against the number of points in each mesh'
set logscale xy
set format x '10^{%T}'
set format y '10^{%T}'
set xlabel 'N, points in each mesh'
set ylabel 'time, ms'
set key outside right
plot for [k = 2:8] dir . '/growth.csv' using 1:k with linespoints ls k - 1 \
         title word(stage, k - 1), \
     x * 1e-4 with lines ls 9 dt 2 title 'slope 1'

name = 'perpoint'; wide = 900; high = 560
load begin
set title 'The same for each point: level where the stage is linear'
set logscale x
set format x '10^{%T}'
set xlabel 'N, points in each mesh'
set ylabel 'time for each point of a mesh, microseconds'
set yrange [0:*]
set key outside right
plot for [k = 2:8] dir . '/growth.csv' using 1:(1e3 * column(k) / $1) with linespoints \
         ls k - 1 title word(stage, k - 1)

name = 'paper'; wide = 900; high = 480
load begin
set title 'Tables 2 to 4: the paper''s times (Athlon 2600+) and ours'
set logscale xy
set xlabel 'points'
set ylabel 'time, ms'
set xrange [5e3:3e5] # the paper's sizes; reduced, there is one
set format y '10^{%T}'
set key outside right
plot for [t = 2:4] dir . '/tables.csv' using ($1 == t ? $3 : NaN):4 with linespoints ls t - 1 \
         dt 2 title sprintf('table %d, paper', t), \
     for [t = 2:4] dir . '/tables.csv' using ($1 == t ? $3 : NaN):5 with linespoints ls t - 1 \
         title sprintf('table %d, here', t)
