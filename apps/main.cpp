#include "fathom/error.h"
#include "fathom/load.h"
#include "fathom/render.h"

int main() { return 0; }
