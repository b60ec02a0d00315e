set title "x"
plot x
