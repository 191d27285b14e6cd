# Tables 2 to 4.
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
