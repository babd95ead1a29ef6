/* The smallest importer, compiled for each platform: runner LIBRARY TOKEN REFERENCE...
   Co-Simulation of FMI 2.0 over 600 s in steps of 1 s; prints the values in hexadecimal. */
#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
static void *library_of(const char *path) { return LoadLibraryA(path); }
static void *function_of(void *library, const char *name) { return (void *)GetProcAddress(library, name); }
static int unload(void *library) { return !FreeLibrary(library); }
#else
#include <dlfcn.h>
static void *library_of(const char *path) { return dlopen(path, RTLD_NOW); }
static void *function_of(void *library, const char *name) { return dlsym(library, name); }
static int unload(void *library) { return dlclose(library); }
#endif

typedef void *(*Instantiate)(const char *, int, const char *, const char *, const void *, int, int);
typedef int (*Plain)(void *);
typedef int (*Step)(void *, double, double, int);
typedef int (*Get)(void *, const unsigned *, size_t, double *);

static void *need(void *library, const char *name) {
    void *function = function_of(library, name);
    if (!function) {
        fprintf(stderr, "%s is missing\n", name);
        exit(1);
    }
    return function;
}

int main(int count, char **arguments) {
    if (count < 4) return 2;
    void *library = library_of(arguments[1]);
    if (!library) {
        fprintf(stderr, "%s cannot be loaded\n", arguments[1]);
        return 1;
    }
    Step step = (Step)need(library, "fmi2DoStep");
    Get get = (Get)need(library, "fmi2GetReal");
    void *unit = ((Instantiate)need(library, "fmi2Instantiate"))("unit", 1, arguments[2], "", NULL, 0, 0);
    if (!unit || ((Plain)need(library, "fmi2EnterInitializationMode"))(unit) ||
        ((Plain)need(library, "fmi2ExitInitializationMode"))(unit)) {
        fprintf(stderr, "no instance\n");
        return 1;
    }
    for (int i = 0; i < 600; i++)
        if (step(unit, i, 1.0, 1)) return 1;
    for (int i = 3; i < count; i++) {
        unsigned reference = (unsigned)strtoul(arguments[i], NULL, 10);
        union { double number; unsigned long long bits; } value;
        if (get(unit, &reference, 1, &value.number)) return 1;
        printf("%016llx%c", value.bits, i + 1 < count ? ' ' : '\n');
    }
    ((void (*)(void *))need(library, "fmi2FreeInstance"))(unit);
    // Importers unload what they have used; the program then ends without the code of the library.
    return unload(library);
}
