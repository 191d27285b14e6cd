# Two faces before and after alignment; of so many triangles SVG would be far too large.
if (kind eq 'png') {
array title[2] = ['the same person again', 'another person']
do for [k = 1:2] {
    who = word('person other', k)
    name = who; wide = 1000; high = 460
    load begin
    set datafile separator whitespace
    set multiplot layout 1,2 title 'A template (blue) and ' . title[k] . ' (orange)'
    load shaded
    set view 20, 20, 1.6
    set view equal xyz
    do for [pose in 'before after'] {
        set title (pose eq 'before' ? 'Figure 10: as scanned' : 'Figure 11: after alignment')
        splot dir . '/template.dat' using 1:2:3:4 with pm3d, \
              sprintf('%s/%s-%s.dat', dir, who, pose) using 1:2:3:($4 + 1) with pm3d
    }
    unset multiplot
    name = who . '-gap'; wide = 1000; high = 460
    load begin
    set datafile separator whitespace
    set multiplot layout 1,2 title 'The gap between a template and ' . title[k]
    set size ratio -1
    unset grid
    unset key
    set xlabel 'x, mm'
    set ylabel 'y, mm'
    set xrange [-75:75]
    set yrange [-90:90]
    set palette defined (-1 '#2166ac', -0.5 '#92c5de', 0 '#f7f7f7', 0.5 '#f4a582', 1 '#b2182b')
    set cbrange [-4:4]
    set cblabel 'signed gap, second minus template, mm'
    do for [pose in 'before after'] {
        set title (pose eq 'before' ? 'as scanned' : 'after alignment')
        plot sprintf('%s/%s-%s-gap.dat', dir, who, pose) using 1:2:3 with image pixels
    }
    unset multiplot
}
}
