# The disparity-measure paper's figures 1 to 9.
name = 'walks'; wide = 960; high = 500
load begin
set multiplot layout 1,2
set size ratio -1
set xrange [0:1]
set yrange [0:1]
set xlabel 'x'
set ylabel 'y'
unset key
unset grid
set style fill solid 0.5 noborder
do for [k in 'fig1 fig2'] {
    set title (k eq 'fig1' ? 'Figure 1: the walk from M to Q' : 'Figure 2: a vertex C on the way')
    plot dir . '/' . k . '-path.csv' using 2:3 with filledcurves closed lc rgb '#fdd0a2', \
         dir . '/' . k . '-edges.csv' using 2:3:($4-$2):($5-$3) with vectors nohead ls 9, \
         dir . '/' . k . '-path.csv' using 2:3 with lines ls 2, \
         dir . '/' . k . '-segment.csv' using 1:2 with linespoints ls 1 lw 2 ps 1
}
unset multiplot

name = 'trees'; wide = 960; high = 500
load begin
set multiplot layout 1,2
set size ratio -1
set xrange [0:1]
set yrange [0:1]
set xlabel 'x'
set ylabel 'y'
unset key
unset grid
set style fill solid 0.5 noborder
set title 'Figure 3: minimum spanning tree of a Delaunay graph'
plot dir . '/fig3-edges.csv' using 2:3:($4-$2):($5-$3) with vectors nohead ls 9, \
     dir . '/fig3-tree.csv' using 1:2:($3-$1):($4-$2) with vectors nohead ls 1 lw 2.5
set title 'Figure 4: a mesh located along its own tree'
plot dir . '/fig4-path.csv' using 2:3 with filledcurves closed lc rgb '#fdd0a2', \
     dir . '/fig3-edges.csv' using 2:3:($4-$2):($5-$3) with vectors nohead ls 9, \
     dir . '/fig4-tree.csv' using 1:2:($3-$1):($4-$2) with vectors nohead ls 1 lw 2.5, \
     dir . '/fig4-tree.csv' using 1:2 with points ls 1
unset multiplot

name = 'steps'; wide = 800; high = 460
load begin
set title 'Triangles entered per point located, N points in a mesh of N'
set logscale xy
set format x '10^{%T}'
set xlabel 'N, points in each mesh'
set ylabel 'triangles entered per point'
set key top left
plot dir . '/steps.csv' using 1:5 every ::1 with linespoints ls 2 title 'each from the middle', \
     dir . '/steps.csv' using 1:3 every ::1 with linespoints ls 1 title 'along the spanning tree', \
     0.5 * sqrt(x) with lines ls 9 dt 2 title 'square root of N (slope alone)'

if (kind eq 'png') { # of so many triangles SVG would be hundreds of megabytes
name = 'interpolation'; wide = 1000; high = 1640
load begin
set datafile separator whitespace
set multiplot layout 4,2
load shaded
array points[8]
points[5] = 'N = 1,000'; points[6] = 'N = 10,000'; points[7] = 'N = 10,000'; points[8] = 'N = 15,000'
file(k, i) = sprintf('%s/fig%d-%d.dat', dir, k, i)
do for [k = 5:8] {
    stats file(k, 2) using 3 nooutput
    lift = 1.5 * (STATS_max - STATS_min) # the upper surface above the lower one
    do for [i = 2:3] {
        set title sprintf('Figure %d, %s: ', k, points[k]) \
            . (i == 2 ? '(1) above, (2) below, as given' : 'below (3), on the points of (1)')
        splot file(k, i) using 1:2:3:($4 + 1) with pm3d, \
              file(k, 1) using 1:2:($3 + lift):4 with pm3d
    }
}
unset multiplot
}

name = 'fig9'; wide = 1000; high = 640
load begin
set datafile separator whitespace
set multiplot layout 2,3 title 'Figure 9: the gap over one cell, by the signs at its corners'
set xrange [0:1]
set yrange [0:1]
set zrange [-2:3]
set cbrange [-3:3]
set palette defined (-3 '#2166ac', -0.01 '#d1e5f0', 0 '#cccccc', 0.01 '#fddbc7', 3 '#b2182b')
set xyplane at -2
set view 65, 35
set xtics 0.5
set ytics 0.5
set ztics 1
set xlabel 'x'
set ylabel 'y'
set zlabel 'gap' offset 5,5
set pm3d depthorder interpolate 32,32
set style fill transparent solid 0.8
unset key
unset colorbox
do for [c in 'a b c d e'] {
    set title '(' . c . ')' offset 0,-1
    splot dir . '/fig9-' . c . '.dat' with pm3d
}
unset multiplot
