# Above: the values of each estimator at its rates, forces or windows, and the reference. Below: figure of merit.
names = "'shear' 'shear, no pair noise' 'Poiseuille' 'at rest'"
quantities = "viscosity poiseuille_viscosity green_kubo_viscosity"
array colour[4] = [blue, sky, red, green]
array start[4] = [1, 4.5, 8, 10.5]
array settings[4] = ["0.1 0.2 0.4", "0.1 0.2 0.4", "0.02 0.05", "0.5 1 2"]
array what[4] = ["shear,\nrate", "shear without\npair noise, rate", "opposed Poiseuille,\nforce", "at rest,\nwindow"]
part(k) = word(names, k).":".(k < 3 ? "viscosity:curve:reference" : word(quantities, k-1).":quantity:viscosity")
place(k, x) = start[k] + sum [i=1:words(settings[k])] (abs(x/word(settings[k], i) - 1) < 1e-6 ? i-1 : 0)
# what is joined with the reference comes with its seconds
seconds(k, all) = all - (k < 3 ? 0 : reference_seconds)
merit(k, value, error, all) = (value/error)**2/seconds(k, all)
number(m) = sprintf(m < 10 ? "%.1f" : "%.0f", m)
small = ",".(caption_size - 1)

set table $kept
plot data index "reference:profile_slope" using 1:(reference_seconds = $9), \
     data index "all:reference:viscosity" using 1:(reference = $2, reference_error = $3, $2)
unset table

set multiplot
set boxwidth 0.7
unset key; unset mxtics; unset xlabel; unset logscale
set xrange [0.3:13.2]
unset xtics
set title title_text offset 0,-0.4
set tmargin at screen 0.93; set bmargin at screen 0.58
set yrange [*:*]; set ytics auto; set mytics
set ylabel "viscosity η" offset 0.5,0
plot reference with filledcurves y=reference+reference_error fs solid 0.2 noborder lc rgb grey, \
     reference with filledcurves y=reference-reference_error fs solid 0.2 noborder lc rgb grey, \
     reference with lines lw 2 lc rgb grey, \
     for [k=1:4] data index part(k) using (place(k, $1)):2:3 with yerrorbars pt 7 lw 1.5 lc rgb colour[k]
unset title
set tmargin at screen 0.555; set bmargin at screen 0.28
set xtics () scale 0
do for [k=1:4] { do for [i=1:words(settings[k])] { set xtics add (word(settings[k], i) start[k]+i-1) } }
do for [k=1:4] { set label 10+k what[k] at start[k]+0.5*(words(settings[k])-1), screen 0.225 center font small }
set label 1 caption at screen 0.025,0.115 noenhanced font ",".caption_size
set logscale y; set yrange [0.3:6000]
set ylabel "figure of merit (1/s)" offset 0.5,0
plot for [k=1:4] data index part(k) using (place(k, $1)):(merit(k, $2, $3, $9)) with boxes fs solid 0.6 noborder lc rgb colour[k], \
     for [k=1:4] data index part(k) using (place(k, $1)):(merit(k, $2, $3, $9)):(number(merit(k, $2, $3, $9))) with labels offset 0,0.6 font small
unset multiplot
unset label; unset logscale
