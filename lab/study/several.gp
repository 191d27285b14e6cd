# The best of several templates.
name = 'several'; wide = 900; high = 440
load begin
set multiplot layout 1,2 title 'False match rate of the best of n, made-up people'
set xlabel 'threshold'
set ylabel 'false match rate, %'
set logscale y
set key top right
many = '1 5 20'
do for [k = 0:1] {
    set title (k == 0 ? 'as it is' : 'less ln n')
    plot for [i = 1:3] dir . '/curve.csv' \
        using (stringcolumn(1) eq 'made up' && $2 == word(many, i) && column(6 + 3 * k) > 0 ? $3 : NaN):(column(6 + 3 * k)) \
        with lines ls i title word(many, i) . ' templates'
}
unset multiplot
