# Kinetic temperature at the largest usable step that was tried: a row per integrator, a column per friction.
load scripts."/names.gp"
map = file("friction")
frictions = "0.1 1 4.5 10 100 1000"
column_of(friction) = sum [i=1:words(frictions)] (abs(friction/word(frictions, i) - 1) < 1e-6 ? i : 0)
known(c) = column(usable + 1) == 0 ? column(c) : NaN  # not where there is no edge
cell(kT, error) = kT == kT ? sprintf("%.2f ± %.1g", kT, error) : ""
set multiplot
unset key; unset colorbox; unset grid; unset mxtics; unset mytics
set lmargin at screen 0.16
set palette defined (0.9 "#ffffff", 2 "#E69F00")
set cbrange [0.9:2]
set xrange [0.5:words(frictions)+0.5]
set xtics scale 0 ("" 1); set ytics scale 0 ()
do for [k=1:10] { set ytics add (name[k] k) }

set tmargin at screen 0.93; set bmargin at screen 0.70
set yrange [5.5:0.5]
set title "k_BT at the largest usable step, no repulsion" offset 0,-0.5
plot for [k=1:5] map index name[k].":0" using (column_of($1)):(k):(0.49):(0.47):(known(8)) with boxxyerror fs solid noborder lc palette, \
     for [k=1:5] map index name[k].":0" using (column_of($1)):(k):(cell(known(8), $9)) with labels font ",12"

set tmargin at screen 0.62; set bmargin at screen 0.16
set yrange [10.5:0.5]
set title "The same with repulsion a = 25"
do for [i=1:words(frictions)] { set xtics add (word(frictions, i) i) }
set xlabel "friction γ" offset 0,0.2
set label 1 "Set temperature 1, limit of what counts as usable 2.\nBlank, and without repulsion those not shown: no edge." at screen 0.03,0.05 font ",".caption_size
plot for [k=1:10] map index name[k].":25" using (column_of($1)):(k):(0.49):(0.47):(known(8)) with boxxyerror fs solid noborder lc palette, \
     for [k=1:10] map index name[k].":25" using (column_of($1)):(k):(cell(known(8), $9)) with labels font ",12"
unset multiplot
unset label 1
