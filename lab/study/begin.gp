# begin.gp -- a picture begins: name, wide and high (pixels) are set by the caller; kind
# (svg or png) and dir by scripts/studies.
reset
if (kind eq 'svg') {
    set terminal svg size wide,high font 'Sans,12' background 'white'
} else { # of 256 colours: a picture has one palette
    set terminal png size wide,high font 'Sans,10'
}
set output dir . '/' . name . '.' . kind
set datafile separator ','
set style line 1 lc rgb '#0060ad' lw 1.5 pt 7 ps 0.6
set style line 2 lc rgb '#d95f02' lw 1.5 pt 5 ps 0.6
set style line 3 lc rgb '#1b9e77' lw 1.5 pt 9 ps 0.7
set style line 4 lc rgb '#7570b3' lw 1.5 pt 13 ps 0.7
set style line 5 lc rgb '#e7298a' lw 1.5 pt 11 ps 0.7
set style line 6 lc rgb '#666666' lw 1.5 pt 4 ps 0.6
set style line 7 lc rgb '#a6761d' lw 1.5 pt 6 ps 0.7
set style line 9 lc rgb '#b0b0b0' lw 1
set palette defined (0 '#30408f', 0.5 '#5fb7a4', 1 '#fde725')
set grid lc rgb '#dddddd'
set border lc rgb '#444444'
