# Builds a method outside of treeline's tree, from the same files as within:
#   make -f "$(pkg-config --variable=makefile treeline)" NAME.so     from NAME.c and, where there is one, NAME.glsl
here := $(dir $(lastword $(MAKEFILE_LIST)))

.SECONDEXPANSION:
.SECONDARY:
%.so: %.c $$(addsuffix .h,$$(wildcard $$*.glsl))
	$(CC) -O3 -g $(CFLAGS) -fPIC -shared $(shell pkg-config --cflags treeline) -o $@ $<
%.glsl.h: %.glsl
	@$(here)glsl_to_c.sh $< > $@
