# Four quantities (rows) at three steps (columns): deviation over friction x step and density. The deviation of the
# total is that of the sum of both parts from the sum of their theories, whose values the first pass keeps. memory.gp
# sets `forms` for the theory with memory and draws the same.
if (!exists("forms")) forms = "ng8 ng12 ng17"
dts = "0.05 0.2 1"; densities = "1 3 8 20"; couplings = "0.1 0.3 1 3"
cells = words(dts)*words(densities)*words(couplings)
chaos = word(forms, 1) eq "ng8"
array label[4] = ["kinetic viscosity".(chaos ? ", eq. 8" : ""), "collision".(chaos ? ", eq. 12" : ""), "their sum", "diffusion".(chaos ? ", eq. 17" : "")]
array kinetic[cells]; array collision[cells]
curve(t, n) = "dt=".word(dts, t)." n=".word(densities, n)
index_of(coupling) = sum [i=1:words(couplings)] (abs(coupling/word(couplings, i) - 1) < 1e-6 ? i : 0)
place(t, friction) = index_of(friction*word(dts, t))
slot(t, n, friction) = ((t-1)*words(densities) + n-1)*words(couplings) + place(t, friction)
theory(t, n, friction) = kinetic[slot(t, n, friction)] + collision[slot(t, n, friction)]
set table $kept
plot for [t=1:3] for [n=1:4] data index curve(t, n).":kinetic_viscosity:".word(forms, 1) using 1:(kinetic[slot(t, n, $1)] = $4), \
     for [t=1:3] for [n=1:4] data index curve(t, n).":collision_viscosity:".word(forms, 2) using 1:(collision[slot(t, n, $1)] = $4)
unset table

part(q, t, n) = q == 3 ? "all:".curve(t, n).":viscosity" : \
                curve(t, n).":".word("kinetic_viscosity collision_viscosity - diffusion_constant", q).":".word(forms, q == 4 ? 3 : q)
# in per cent; columns: x, value, error, theory, deviation, its error, of the sum the first three only
deviation(q, t, n) = 100*(q == 3 ? column(2)/theory(t, n, column(1)) - 1 : column(5))
error(q, t, n) = 100*(q == 3 ? column(3)/theory(t, n, column(1)) : column(6))
blurred(q, t, n) = error(q, t, n) > 5 && error(q, t, n) > 0.2*abs(deviation(q, t, n))
ink(q, t, n) = blurred(q, t, n) ? 0x999999 : 0
number(d) = sprintf(abs(d) < 100 ? "%+.1f" : "%+.0f", d)
margin(e) = sprintf("±%.1f", e)
small = ",".(caption_size - 2); tiny = ",".(caption_size - 3)

set multiplot
set border 31 lw 1.2
unset key; unset grid; unset colorbox; unset mxtics; unset mytics; unset xlabel; unset ylabel
set palette defined (-50 "#0072B2", -10 "#9fd0ee", 0 "#ffffff", 10 "#f3cf8a", 50 "#D55E00")
set cbrange [-50:50]
set xrange [0.5:words(couplings)+0.5]; set yrange [0.5:words(densities)+0.5]
set label 10 title_text at screen 0.53,0.975 center
set label 4 "density n*" at screen 0.025,0.56 center rotate
do for [q=1:4] {
  do for [t=1:3] {
    set lmargin at screen 0.09 + 0.30*(t-1); set rmargin at screen 0.09 + 0.30*(t-1) + 0.29
    set tmargin at screen 0.925 - 0.19*(q-1); set bmargin at screen 0.925 - 0.19*(q-1) - 0.16
    unset xtics; unset ytics
    if (t == 1) {
      set ytics scale 0 () font small
      do for [n=1:words(densities)] { set ytics add (word(densities, n) n) }
    }
    if (q == 4) {
      set xtics scale 0 () font small
      do for [i=1:words(couplings)] { set xtics add (word(couplings, i) i) }
    }
    set label 2 label[q].", Δt* = ".word(dts, t) at graph 0.5,1.07 center font small
    plot for [n=1:4] data index part(q, t, n) using (place(t, $1)):(n):(0.49):(0.48):(blurred(q, t, n) ? 0 : deviation(q, t, n)) with boxxyerror fs solid noborder lc palette, \
         for [n=1:4] data index part(q, t, n) using (place(t, $1)):(n+0.20):(number(deviation(q, t, n))):(ink(q, t, n)) with labels font small tc rgb variable, \
         for [n=1:4] data index part(q, t, n) using (place(t, $1)):(n-0.24):(margin(error(q, t, n))):(ink(q, t, n)) with labels font tiny tc rgb variable
    unset label 4; unset label 10
  }
}
set label 3 "friction × step γΔt/m" at screen 0.53,0.142 center
set label 1 caption at screen 0.025,0.10 noenhanced font ",".caption_size
unset label 2; unset border; unset xtics; unset ytics
plot [0:1][0:1] NaN notitle
unset multiplot
unset label
