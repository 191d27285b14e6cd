# report.awk -- report.html with its directives carried out, a directive a line:
#   @run             what was run, when, and on what
#   @contents        links to the studies
#   @study NAME      studies/NAME.html, if out/NAME is there; in it:
#   @table FILE | CAPTION    a CSV file as a table
#   @maybe FILE | CAPTION    the same where the file is there
#   @figure NAME | CAPTION   a picture, in the page: the SVG, or the PNG of a large one or one without
#   @maybe-figure NAME | CAPTION   the same where it is there
function text(s) {
    gsub(/&/, "\\&amp;", s); gsub(/</, "\\&lt;", s); gsub(/>/, "\\&gt;", s)
    return s
}

function there(file,    line, got) {
    got = (getline line < file) > 0
    close(file)
    return got
}

function table(file, caption,    line, n, i, field, cell) {
    print "<div class=\"scroll\"><table><caption>" caption "</caption>"
    cell = "th"
    while ((getline line < file) > 0) {
        n = split(line, field, ",")
        printf "<tr>"
        for (i = 1; i <= n; i++)
            printf "<%s>%s</%s>", cell, text(field[i]), cell
        print "</tr>"
        cell = "td"
    }
    close(file)
    print "</table></div>"
}

function figure(base, caption,    command, size, kind, name) {
    name = base
    sub(/.*\//, "", name)
    command = "cat '" base ".svg' 2>/dev/null | wc -c"
    command | getline size
    close(command)
    kind = size > 0 && size < 400000 ? "svg" : "png"
    printf "<figure><img alt=\"%s\" src=\"data:image/%s;base64,", name, kind == "svg" ? "svg+xml" : kind
    fflush()
    system("base64 -w 0 '" base "." kind "'")
    print "\"><figcaption>" caption "</figcaption></figure>"
}

function directive(line, study,    at) {
    at = index(line, " | ")
    if (line ~ /^@table /)
        table(out "/" study "/" substr(line, 8, at - 8), substr(line, at + 3))
    else if (line ~ /^@maybe /) {
        if (there(out "/" study "/" substr(line, 8, at - 8)))
            table(out "/" study "/" substr(line, 8, at - 8), substr(line, at + 3))
    } else if (line ~ /^@maybe-figure /) {
        if (there(out "/" study "/" substr(line, 15, at - 15) ".svg"))
            figure(out "/" study "/" substr(line, 15, at - 15), substr(line, at + 3))
    } else if (line ~ /^@figure /)
        figure(out "/" study "/" substr(line, 9, at - 9), substr(line, at + 3))
    else
        print line
}

/^@study / {
    file = "lab/study/" $2 ".html"
    if (!there(out "/" $2 "/done"))
        next
    print "<section id=\"" $2 "\">"
    while ((getline line < file) > 0)
        directive(line, $2)
    close(file)
    print "</section>"
    next
}
/^@contents/ {
    print "<nav>"
    while ((getline line < FILENAME) > 0)
        if (split(line, word, " ") == 2 && word[1] == "@study" && there(out "/" word[2] "/done"))
            print "<a href=\"#" word[2] "\">" word[2] "</a>"
    close(FILENAME)
    print "</nav>"
    next
}
{ sub(/@run/, text(run)); print }
