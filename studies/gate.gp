# How much like a face: faces, and what is none.
name = 'likeness'; wide = 760; high = 420
load begin
set title 'How much like a face'
set xlabel 'likeness'
set ylabel 'scans'
set key top left
bin(x) = 0.05 * (floor(x / 0.05) + 0.5)
set boxwidth 0.045
set style fill transparent solid 0.5 noborder
set xrange [-1:1]
plot for [set_of in "things reliefs sought faces"] dir . '/scans.csv' every ::1 \
     using (stringcolumn(1) eq set_of ? bin(column(6)) : NaN):(1) smooth frequency \
     with boxes title set_of
