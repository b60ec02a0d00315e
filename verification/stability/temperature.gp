# Error of the kinetic temperature at the largest usable step that was tried. Integrators side by side, so that
# their symbols do not hide each other.
load scripts."/names.gp"
map = file("friction")
known(c) = column(usable + 1) == 0 ? column(c) : NaN  # not where there is no edge
beside(k) = $1*1.06**(k - 5.5)
set multiplot
set logscale x
set xrange [0.07:1500]
set ylabel "k_BT just below the edge" offset 0.5,0
set yrange [0.8:2.1]

set tmargin at screen 0.95; set bmargin at screen 0.58
set title "Temperature at the largest usable step (set: 1, limit: 2)" offset 0,-0.5
set format x ""
set label 1 "no repulsion" at graph 0.03,0.08
unset key
plot for [y=1:2] y with lines lw 2 lc rgb grey notitle, \
     for [k=1:10] map index name[k].":0" using (beside(k)):(known(8)):9 with yerrorbars pt symbol[k] ps 1.2 lw 1.2 lc rgb colour[k] notitle

set tmargin at screen 0.56; set bmargin at screen 0.20
unset title
set format x "%g"
set xlabel "friction γ: 0.1, 1, 4.5, 10, 100, 1000 (symbols side by side)" offset 0,0.4
set label 1 "repulsion a = 25"
set key at screen 0.53,0.06 center center maxrows 3 samplen 1.2 width -1
plot for [y=1:2] y with lines lw 2 lc rgb grey notitle, \
     for [k=1:10] map index name[k].":25" using (beside(k)):(known(8)):9 with yerrorbars pt symbol[k] ps 1.2 lw 1.2 lc rgb colour[k] title name[k]
unset multiplot
