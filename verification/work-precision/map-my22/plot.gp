# Two maps of the deviation of eq. 22 over step and density, and below both against the step over the critical one.
# Without memory eq. 22 is 1/(1 - step/critical step), which gives the fraction from the theory value.
steps = "0.01 0.02 0.04 0.07 0.1 0.2 0.3 0.4 0.5"
densities = "1 3 5 10 30"
kinds = "'' ' edge' ' hot'"
array colour[5] = [green, blue, sky, purple, red]
friction = 4.5
column_of(step) = sum [i=1:words(steps)] (abs(step - word(steps, i)) < 1e-9 ? i : 0)
part(prefix, n, k) = prefix."n=".word(densities, n).word(kinds, k).":kinetic_temperature:my22"
cell(deviation, error) = deviation > 1 ? sprintf("×%.3g", 1 + deviation) : sprintf("%+.1f±%.1f", 100*deviation, 100*error)
small = ",".(caption_size - 1); tiny = ",".(caption_size - 2)

set multiplot
unset key; unset grid; unset colorbox; unset xlabel
set lmargin at screen 0.10; set rmargin at screen 0.975
set palette defined (-15 "#56B4E9", 0 "#ffffff", 15 "#E69F00")
set cbrange [-15:15]
set xrange [0.5:words(steps)+0.5]; set yrange [0.5:words(densities)+0.5]
set xtics scale 0; set ytics scale 0; unset mxtics; unset mytics
set ytics ()
do for [n=1:words(densities)] { set ytics add (word(densities, n) n) }
unset ylabel
set label 4 "density n" at screen 0.025,0.71 center rotate

do for [m=1:2] {
  prefix = m == 1 ? "" : "old momentum "
  set title (m == 1 ? title_text : "") offset 0,0.2
  set tmargin at screen (m == 1 ? 0.935 : 0.70); set bmargin at screen (m == 1 ? 0.715 : 0.48)
  set label 2 (m == 1 ? "moved after the kick" : "moved with the momentum from before the kick") at graph 0.995,0.93 right font small
  unset xtics
  if (m == 2) {
    unset label 4
    set xtics () scale 0 font small
    do for [i=1:words(steps)] { set xtics add (sprintf("%s\n%.3g", word(steps, i), friction*word(steps, i)) i) }
    set label 3 "Δt\nγΔt/m" at screen 0.095,0.468 right font small
  }
  plot for [n=1:5] for [k=1:3] data index part(prefix, n, k) using (column_of($1)):(n):(0.49):(0.47):(100*$5) with boxxyerror fs solid noborder lc palette, \
       for [n=1:5] for [k=1:3] data index part(prefix, n, k) using (column_of($1)):(n):(cell($5, $6)) with labels font small
}

set tmargin at screen 0.405; set bmargin at screen 0.215
unset title; unset label 2; unset label 3
set grid back ls 100
set xtics auto scale 0.8 font ""; set format x "%g"; set mxtics; set ytics auto; set mytics
set xrange [0:1]; set yrange [-20:10]
set xlabel "step over critical step" offset 0,0.5
set ylabel "deviation (%)" offset 0.5,0
set key bottom right maxrows 2 samplen 1 font tiny
set label 1 caption at screen 0.025,0.115 noenhanced font ",".caption_size
fraction(theory) = 1 - 1/theory
plot 0 with lines lw 2 lc rgb grey notitle, \
     for [n=1:5] for [k=1:2] data index part("", n, k) using (fraction($4)):(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb colour[n] title k == 1 ? "n = ".word(densities, n) : "", \
     for [n=1:5] for [k=1:2] data index part("old momentum ", n, k) using (fraction($4)):(100*$5):(100*$6) with yerrorbars pt 6 lw 1.5 lc rgb colour[n] notitle, \
     for [k=1:2] data index "friction 0.5".word(kinds, k).":kinetic_temperature:my22" using (fraction($4)):(100*$5):(100*$6) with yerrorbars pt 1 ps 1.4 lw 2 lc rgb black title k == 1 ? "γ = 0.5" : "", \
     for [k=1:2] data index "friction 18".word(kinds, k).":kinetic_temperature:my22" using (fraction($4)):(100*$5):(100*$6) with yerrorbars pt 2 ps 1.4 lw 2 lc rgb black title k == 1 ? "γ = 18" : ""
unset multiplot; unset label 1
