# Largest usable step over friction and repulsion, n = 3.
load scripts."/names.gp"
map = file("map")
array shown[4] = [2, 4, 5, 6]
set tics font ",".caption_size
set multiplot layout 2,2 title "Largest usable step Δt, density 3" margins 0.10,0.88,0.09,0.91 spacing 0.10,0.09
set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
set logscale cb; set cbrange [3e-4:10]; set format cb "10^{%T}"
unset grid; unset key; unset mxtics; unset mytics
index_of(list, x) = int(sum [k=1:words(list)] (abs(real(word(list, k)) - x) < 1e-6*(1 + x) ? k : 0))
frictions = "0.1 1 4.5 10 100 1000"; repulsions = "0 5 25 100 500"
# the step to three digits; black on the light colours, white on the others
number(dark) = (column(usable) < 0.5) == dark ? (column(usable + 1) == 1 ? "≥" : "").sprintf("%.3g", column(usable)) : ""
set xrange [0.5:words(frictions) + 0.5]; set yrange [0.5:words(repulsions) + 0.5]
set for [k=1:words(frictions)] xtics add (word(frictions, k) k)
set for [k=1:words(repulsions)] ytics add (word(repulsions, k) k)
do for [p=1:4] {
    k = shown[p]
    set title name[k] offset 0,-0.7
    if (p > 2) { set xlabel "friction γ" offset 0,0.5 } else { unset xlabel }
    if (p % 2) { set ylabel "repulsion a" offset 1.5,0 } else { unset ylabel }
    if (p == 4) { set colorbox user origin 0.90,0.09 size 0.025,0.82 } else { unset colorbox }
    plot map index name[k].":3" using (index_of(frictions, $1)):(index_of(repulsions, $2)):usable with image, \
         map index name[k].":3" using (index_of(frictions, $1)):(index_of(repulsions, $2)):(number(1)) with labels font sprintf(",%g", 0.7*caption_size) tc rgb "white", \
         map index name[k].":3" using (index_of(frictions, $1)):(index_of(repulsions, $2)):(number(0)) with labels font sprintf(",%g", 0.7*caption_size) tc rgb "black"
}
unset multiplot
