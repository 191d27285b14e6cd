# report.awk -- report.html with its directives carried out, a directive a line:
#   @run             what was run, when, and on what
#   @contents        links to the studies, their tables and figures
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

# A number, as one reads it: 120,238.8
function number(s,    whole, rest) {
    if (s !~ /^-?[0-9]+(\.[0-9]*)?$/)
        return text(s)
    whole = rest = s
    sub(/\..*/, "", whole)
    sub(/^[^.]*/, "", rest)
    while (whole ~ /[0-9][0-9][0-9][0-9]/ && s !~ /^[0-9][0-9][0-9][0-9]$/)
        whole = separate(whole)
    return whole rest
}

# 1234567 -> 1234,567 -> 1,234,567
function separate(s,    at) {
    at = match(s, /[0-9][0-9][0-9][0-9](,|$)/)
    return substr(s, 1, at) "," substr(s, at + 1)
}

# The caption's first sentence is its title.
function caption_of(s,    at) {
    at = match(s, /[.?] /)
    return at ? "<b>" substr(s, 1, at) "</b>" substr(s, at + 1) : "<b>" s "</b>"
}

function table(file, caption,    line, rows, r, n, i, field, cell, is_text) {
    while ((getline line < file) > 0) {
        if (rows == 0) {
            gsub(/mm3/, "mm\302\263", line); gsub(/mm2/, "mm\302\262", line); gsub(/ us /, " \302\265s ", line)
        }
        n = split(line, field, ",")
        for (i = 1; i <= n; i++) {
            cell[rows, i] = field[i]
            is_text[i] = is_text[i] || i == 1 || (rows > 0 && field[i] ~ /[A-Za-z]/)
        }
        rows++
    }
    close(file)
    print "<div class=\"scroll\" id=\"" name_of(file) "\"><table><caption>" caption_of(caption) "</caption>"
    for (r = 0; r < rows; r++) {
        printf "<tr>"
        for (i = 1; i <= n; i++)
            printf "<%s%s>%s</%s>", r ? "td" : "th", is_text[i] ? " class=\"text\"" : "",
                r ? number(cell[r, i]) : text(cell[r, i]), r ? "td" : "th"
        print "</tr>"
    }
    print "</table></div>"
}

# out/STUDY/FILE.csv -> STUDY-FILE: the anchor of a table or figure
function name_of(path) {
    sub("^" out "/", "", path)
    sub(/\.csv$/, "", path)
    sub(/\//, "-", path)
    return path
}

function figure(base, caption,    command, size, kind, name) {
    name = base
    sub(/.*\//, "", name)
    command = "cat '" base ".svg' 2>/dev/null | wc -c"
    command | getline size
    close(command)
    kind = size > 0 && size < 100000 ? "svg" : "png"
    printf "<figure id=\"%s\"><img alt=\"%s\" src=\"data:image/%s;base64,", name_of(base), name, kind == "svg" ? "svg+xml" : kind
    fflush()
    system("base64 -w 0 '" base "." kind "'")
    print "\"><figcaption>" caption_of(caption) "</figcaption></figure>"
}

# A study in the contents: its title, and the titles of its tables and figures.
function contents(study,    line, at, title, what) {
    while ((getline line < ("lab/study/" study ".html")) > 0)
        if (line ~ /^<h2>/) {
            gsub(/<[^>]*>/, "", line)
            print "<li><a href=\"#" study "\">" line "</a><ul>"
        } else if (line ~ /^@/ && line !~ /^@maybe/) {
            at = index(line, " | ")
            what = substr(line, 1, at - 1)
            title = substr(line, at + 3)
            sub(/^@[a-z]* /, "", what)
            if (match(title, /[.?] /))
                title = substr(title, 1, RSTART)
            sub(/\.$/, "", title)
            print "<li><a href=\"#" name_of(out "/" study "/" what) "\">" title "</a></li>"
        }
    close("lab/study/" study ".html")
    print "</ul></li>"
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
    print "<nav><h2>Contents</h2><ol>"
    while ((getline line < FILENAME) > 0)
        if (split(line, word, " ") == 2 && word[1] == "@study" && there(out "/" word[2] "/done"))
            contents(word[2])
    close(FILENAME)
    print "</ol></nav>"
    next
}
{ sub(/@run/, text(run)); print }
