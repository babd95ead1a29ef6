O12345 (sub file style)
g20 g90
(inches)
g0 x0. y0. z1.
s1000 m3
m98 p8888 l2
g52 x1. y1.
m98 p8888
g52 x0. y0.
#100 = 5
while [#100 gt 3] do1
  g1 x[#100/10] f20.
  #100 = #100 - 1
end1
g4 p1.5
g04 p750
g101 x0
g1 x1.
g100 x0
m30
o8888 
g0 x.5 y0.
g1 z-.1 f10.
g2 i-.5
g0 z.1
m99
