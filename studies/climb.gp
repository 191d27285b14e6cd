# Hill climbing on the score.
name = 'climb'; wide = 900; high = 440
load begin
stats dir . '/early.csv' using ($9 > 0 ? $1 : NaN) name 'warned' nooutput
stats dir . '/early.csv' using ($8 <= 1 ? $1 : NaN) name 'day' nooutput
set multiplot layout 1,2 title 'Highest score so far, median of the victims'
set xlabel 'attempts'
set ylabel 'score'
set logscale x
set yrange [*:*]
set key bottom right
set arrow from warned_min, graph 0 to warned_min, graph 1 nohead ls 9
set label 'first warning' at warned_min, graph 0.05 rotate by 90 offset -0.7
set arrow from day_max, graph 0 to day_max, graph 1 nohead ls 9
set label 'the first day' at day_max, graph 0.05 rotate by 90 offset -0.7
told = 'exact rounded decision'
do for [from in '"stranger" "mean face"'] {
    set title 'from ' . (from eq 'stranger' ? 'a stranger' : 'the mean face')
    plot for [k = 1:3] dir . '/climb.csv' \
        using (stringcolumn(1) eq from && stringcolumn(2) eq word(told, k) ? $3 : NaN):8 \
        with linespoints ls k title word(told, k), \
        8 with lines dashtype 2 lc rgb 'black' title 'threshold'
}
unset multiplot
