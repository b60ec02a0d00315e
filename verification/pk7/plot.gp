# The crystal: particles of the run with the highest order (global q_4), seen from outside and along its rows; below, order
# parameters of all runs and of ideal lattices of density 3, bonds shorter than 0.85.
side = 34.2/75**(1./3); height = 8.55/75**(1./3)  # in cutoffs, eq. 2 at twenty atoms

set autoscale
best = 0
stats data index "all:runs:global_q4" using 2 name "order" nooutput
stats data index "all:runs:global_q4" using ($2 == order_max ? (best = $1) : NaN) nooutput
set table $crystal
plot data index sprintf("configuration:runs:%g", best) using 1:2:3 with table
set table $global
plot data index "all:runs:global_q4" using 1:2:3 with table
set table $local
plot data index "all:runs:local_q4" using 1:2:3 with table
unset table
x(p) = real(word($crystal[p], 1)) - side/2
y(p) = real(word($crystal[p], 2)) - side/2
z(p) = real(word($crystal[p], 3)) - height/2

# The rows: normal to the lattice planes that stand out most among those 0.61 to 0.64 apart, as far as the spheres of a row.
qx = 2*pi/side; qz = 2*pi/height; h0 = 0; k0 = 0; l0 = 1; top = 0
do for [h=-13:13] { do for [k=0:13] { do for [l=-4:4] {
    q = sqrt(qx**2*(h**2 + k**2) + qz**2*l**2)
    if (q > 9.8 && q < 10.35) {
        stats $crystal using (cos(qx*(h*$1 + k*$2) + qz*l*$3)):(sin(qx*(h*$1 + k*$2) + qz*l*$3)) name "wave" nooutput
        if (wave_sum_x**2 + wave_sum_y**2 > top) { top = wave_sum_x**2 + wave_sum_y**2; h0 = h; k0 = k; l0 = l }}}}}

# Two cameras: turned by `turn` about z, then tipped by `tip`; from far away (1/range) or near.
array turn[2]; array tip[2]; array near[2]
turn[1] = 28*pi/180; tip[1] = 32*pi/180; near[1] = 1./22
down = l0 > 0 ? -1 : 1
turn[2] = h0 == 0 && k0 == 0 ? 0 : atan2(-down*h0, down*k0); tip[2] = atan2(abs(qz*l0), qx*sqrt(h0**2 + k0**2)); near[2] = 0
right(c, a, b) = a*cos(turn[c]) + b*sin(turn[c])
away(c, a, b) = b*cos(turn[c]) - a*sin(turn[c])
depth(c, a, b, d) = away(c, a, b)*cos(tip[c]) - d*sin(tip[c])
scale(c, a, b, d) = 1/(1 + near[c]*depth(c, a, b, d))
across(c, a, b, d) = scale(c, a, b, d)*right(c, a, b)
up(c, a, b, d) = scale(c, a, b, d)*(away(c, a, b)*sin(tip[c]) + d*cos(tip[c]))
# far ones first
set table $far_first
plot $crystal using 0:0:(-depth(1, x($0 + 1), y($0 + 1), z($0 + 1))):(0) smooth zsort with points lc palette
plot $crystal using 0:0:(-depth(2, x($0 + 1), y($0 + 1), z($0 + 1))):(0) smooth zsort with points lc palette
unset table
# edges of the box: start and direction
$edges << EOD
-1 -1 -1 1 0 0
-1 1 -1 1 0 0
-1 -1 1 1 0 0
-1 1 1 1 0 0
-1 -1 -1 0 1 0
1 -1 -1 0 1 0
-1 -1 1 0 1 0
1 -1 1 0 1 0
-1 -1 -1 0 0 1
1 -1 -1 0 0 1
-1 1 -1 0 0 1
1 1 -1 0 0 1
EOD
ax(a) = a*side/2; az(a) = a*height/2

@upper
unset title; set label 2 title_text at screen 0.5525,0.955 center
unset border; unset tics; unset grid; unset key; unset ylabel; unset colorbox
set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
set cbrange [-height/2:height/2]
set style fill solid 1 border lc rgb "#303030"
set size ratio -1
do for [c=1:2] {
    set lmargin at screen c == 1 ? 0.02 : 0.59; set rmargin at screen c == 1 ? 0.57 : 0.98
    half = c == 1 ? 6.3 : 5.4
    set xrange [-half:half]; set yrange [-5.7:4.9]
    if (c == 2) { unset label 2 }
    view = c == 1 ? sprintf("run %g", best) : "along its rows"
    set label 3 view at graph 0.5,0.02 center front
    plot $edges using (across(c, ax($1), ax($2), az($3))):(up(c, ax($1), ax($2), az($3))):(across(c, ax($1 + 2*$4), ax($2 + 2*$5), az($3 + 2*$6)) - across(c, ax($1), ax($2), az($3))):(up(c, ax($1 + 2*$4), ax($2 + 2*$5), az($3 + 2*$6)) - up(c, ax($1), ax($2), az($3))) with vectors nohead lw 1.2 lc rgb grey, \
         $far_first index (c - 1) using (p = $1 + 1, across(c, x(p), y(p), z(p))):(up(c, x(p), y(p), z(p))):(0.27*scale(c, x(p), y(p), z(p))):(z(p)) with circles lw 0.6 lc palette
}
set size noratio; unset label 3
set border; set tics; set grid back ls 100; set key; set style fill empty
@lower
set lmargin at screen 0.14; set rmargin at screen 0.965
set xlabel "q_6" offset 0,0.4
set ylabel "q_4" offset 0.5,0
set xrange [0:0.75]; set yrange [0:0.85]
set xtics auto; set ytics auto
set key top left maxrows 3
$ideal << EOD
0.3536 0.7638 "simple cubic, 6 bonds"
0.5040 0.5312 "simple hexagonal, 8"
0.6285 0.5092 "bcc, 8"
0.5745 0.1909 "fcc, 12"
0.4848 0.0972 "hcp, 12"
EOD
plot $ideal using 1:2 with points pt 4 ps 1.4 lw 2 lc rgb red title "ideal", \
     $ideal using 1:($0 == 1 ? NaN : $2):3 with labels left offset 0.9,0 tc rgb red notitle, \
     $ideal using 1:($0 == 1 ? $2 : NaN):3 with labels center offset 0,0.9 tc rgb red notitle, \
     data index "all:runs:global_q6" using 2:(q = $0 + 1, real(word($global[q], 2))):3:(real(word($global[q], 3))) with xyerrorbars pt 6 ps 1.3 lw 1.5 lc rgb blue title "runs, global", \
     data index "all:runs:local_q6" using 2:(q = $0 + 1, real(word($local[q], 2))):3:(real(word($local[q], 3))) with xyerrorbars pt 7 lw 1.5 lc rgb green title "runs, local"
@finish
unset label
