# The missing-points paper's figures 2 to 8, and the errors of the draws.
name = 'fig2'; wide = 960; high = 660
load begin
set multiplot layout 2,3 title 'Delaunay triangulation of the 36 points and of what removal leaves'
set size ratio -1
set xrange [-0.05:1.05]
set yrange [-0.05:1.05]
set xlabel 'x'
set ylabel 'y'
unset key
unset grid
do for [p in '0 15 30 45 60 75'] {
    set title (p eq '0' ? 'all 36 points' : p . ' % removed')
    plot dir . '/fig2-edges.csv' using (stringcolumn(1) eq p ? $2 : NaN):3:($4-$2):($5-$3) \
             with vectors nohead ls 1, \
         dir . '/fig2-points.csv' using (stringcolumn(1) eq p && $4 == 1 ? $2 : NaN):3 \
             with points pt 6 ps 0.8 lc rgb '#d95f02', \
         dir . '/fig2-points.csv' using (stringcolumn(1) eq p && $4 == 0 ? $2 : NaN):3 \
             with points pt 7 ps 0.6 lc rgb '#0060ad'
}
unset multiplot

array title[6] = ['exponential F1', 'cliff F2', 'saddle F3', 'gentle F4', 'steep F5', 'sphere F6']
array top[6] = [1.2, 0.24, 0.4, 0.35, 0.35, 0.4]
do for [f = 1:6] {
    name = sprintf('fig%d', f + 2); wide = 1000; high = 660
    load begin
    set datafile separator whitespace
    set multiplot layout 2,3 title title[f] . ': surface of all points, and after removal'
    set xrange [0:1]
    set yrange [0:1]
    set zrange [0:top[f]]
    set cbrange [0:top[f]]
    set xtics 0.5 offset 0,-0.3
    set ytics 0.5
    set ztics top[f] / 2
    set xlabel 'x'
    set ylabel 'y'
    set zlabel 'z' offset 4,5
    set xyplane at 0
    set view 58, 320, 1, 1
    set pm3d depthorder border lc rgb '#202020' lw 0.5
    set style fill solid
    unset colorbox
    unset key
    do for [p in '0 15 30 45 60 75'] {
        set title (p eq '0' ? 'all 36 points' : p . ' % removed') offset 0,-1
        splot sprintf('%s/fig%d-%s.dat', dir, f + 2, p) using 1:2:3 with pm3d
    }
    unset multiplot
}

# Of the line being read: v where it is about the function f.
pick(v) = stringcolumn(1) eq f ? v : NaN

name = 'errors'; wide = 960; high = 640
load begin
set multiplot layout 2,3 title 'Mean absolute error against the share removed: median and 5-95 % of the draws'
set xlabel 'points removed, %'
set ylabel 'error (units of z)'
set xrange [0:80]
set yrange [0:*]
set key top left samplen 1
set offsets 0, 0, graph 0.25, 0
do for [f in '"F1 exponential" "F2 cliff" "F3 saddle" "F4 gentle" "F5 steep" "F6 sphere"'] {
    set title f
    plot dir . '/table3.csv' using (pick($2)):(pick($7)):(pick($8)):(pick($9)) \
             with yerrorbars ls 1 title 'at the removed points'
}
unset multiplot

name = 'printed'; wide = 960; high = 640
load begin
set multiplot layout 2,3 title 'Total absolute error: printed in table 2, and recomputed'
set xlabel 'points removed, %'
set ylabel 'total absolute error (units of z)'
set xrange [0:80]
set yrange [1e-6:3e4] # room for the legend below
set logscale y
set format y '10^{%T}'
set ytics 100
set key bottom right samplen 1
do for [f in '"F1 exponential" "F2 cliff" "F3 saddle" "F4 gentle" "F5 steep" "F6 sphere"'] {
    set title f
    plot dir . '/table2.csv' using (pick($2)):(pick($4 > 0 ? $4 : NaN)) \
             with points ls 2 ps 1.2 title 'printed', \
         dir . '/table2.csv' using (pick($2)):(pick($6)):(pick($7)):(pick($8)) \
             with yerrorbars ls 1 title 'recomputed'
}
unset multiplot
