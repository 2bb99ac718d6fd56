quantize_far.sv
quantize.sv
accumulate.sv
skid.sv
forward_difference.sv
