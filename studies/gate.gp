# How much of what is seen the shape of a face explains: of faces, and of what is none.
name = 'support'; wide = 760; high = 420
load begin
set title 'How much of what is seen the shape of a face explains'
set xlabel 'support; dashed: the least at enrolment'
set ylabel 'scans'
set key top left
bin(x) = 0.05 * (floor(x / 0.05) + 0.5)
set boxwidth 0.045
set style fill transparent solid 0.5 noborder
set xrange [-0.6:1]
set arrow from 0.55, graph 0 to 0.55, graph 1 nohead dt 2 lc rgb '#444444'
plot for [set_of in "things reliefs sought faces"] dir . '/scans.csv' every ::1 \
     using (stringcolumn(1) eq set_of ? bin(column(6)) : NaN):(1) smooth frequency \
     with boxes title set_of
