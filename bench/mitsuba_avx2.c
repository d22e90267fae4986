// SPDX-License-Identifier: Apache-2.0
/* Keeps Mitsuba's `llvm_ad_rgb` to AVX2 on a machine with AVX-512: preloaded by scenes.py --avx2. Mitsuba makes its Embree device
   before it compiles anything: then both are told what they may use. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* mitsuba::rtcNewDevice(char const*): Embree comes in Mitsuba's namespace. */
#define NEW_DEVICE _ZN7mitsuba12rtcNewDeviceEPKc
#define STRING_OF(name) #name
#define NAME_OF(name) STRING_OF(name)

typedef void* NewDevice(const char* config);
typedef void SetTarget(const char* processor, const char* features, unsigned lanes);

static void* function_of(const char* library, const char* name)
{
    void* const handle = dlopen(library, RTLD_NOW | RTLD_NOLOAD);
    void* const found = handle ? dlsym(handle, name) : NULL;
    if (!found) {
        fprintf(stderr, "%s has no %s: this Mitsuba can't be kept to AVX2\n", library, name);
        _exit(1);
    }
    return found;
}

void* NEW_DEVICE(const char* config)
{
    char limited[512];
    ((SetTarget*)function_of("libdrjit-core.so", "_Z19jit_llvm_set_targetPKcS0_j"))("x86-64-v3", "", 8);
    snprintf(limited, sizeof limited, "%s%sisa=avx2", config ? config : "", config && *config ? "," : "");
    fputs("Mitsuba is kept to AVX2\n", stderr);
    return ((NewDevice*)function_of("libembree3.so", NAME_OF(NEW_DEVICE)))(limited);
}
