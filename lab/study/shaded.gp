# shaded.gp -- surfaces of triangles (study_triangles()) as one sees them, lit, the nearer one in front.
unset border
unset tics
unset grid
unset key
unset colorbox
set style fill solid noborder
set pm3d depthorder noborder
set palette defined (0 'black', 0.99 '#70b0f0', 1 'black', 2 '#f8b040') # one surface; the other
set cbrange [0:2]
set xyplane at 0
set autoscale
set view 40, 15
