# Hill climbing on the score.
name = 'climb'; wide = 900; high = 440
load begin
set multiplot layout 1,2 title 'Lowest score so far, median of the victims'
set xlabel 'attempts'
set ylabel 'mm'
set logscale x
set yrange [0:0.3]
set key top right
told = 'exact rounded decision'
do for [from in '"stranger" "mean face"'] {
    set title 'from ' . (from eq 'stranger' ? 'a stranger' : 'the mean face')
    plot for [k = 1:3] dir . '/climb.csv' \
        using (stringcolumn(1) eq from && stringcolumn(2) eq word(told, k) ? $3 : NaN):6 \
        with linespoints ls k title word(told, k), \
        0.1378 with lines dashtype 2 lc rgb 'black' title 'threshold'
}
unset multiplot
