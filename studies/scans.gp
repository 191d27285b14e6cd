# Scans as delivered, and the faces that were found in them: a column for each kind.
sources = system(sprintf("cut -d, -f1 '%s/pictures.csv' | uniq", dir))
do for [source in sources] {
    line(k) = sprintf("awk -F, '$1 == \"%s\" { printf \"%%s \", $%d }' '%s/pictures.csv'", source, k, dir)
    names = system(line(2))
    outcome(k, i) = system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $%d }' '%s/pictures.csv'", \
                                   source, word(names, i), k, dir))
    name = source; wide = 160 * words(names); high = 480
    load begin
    set datafile separator whitespace
    set multiplot layout 2,words(names) title source . ': as delivered, by depth; below the face found, covers left out'
    set size ratio -1
    unset grid
    unset key
    unset border
    unset tics
    set xrange [-76:76]
    set yrange [-91:91]
    set lmargin 0.5
    set rmargin 0.5
    do for [row in 'raw face'] {
        do for [i = 1:words(names)] {
            set title (row eq 'raw' ? word(names, i) . "\nas agreed: " . outcome(3, i) \
                                    : "found: " . outcome(4, i)) font ',9'
            plot sprintf('%s/%s_%s_%s.dat', dir, source, word(names, i), row) using 1:2:3:4:5 with rgbimage
        }
    }
    unset multiplot
}
