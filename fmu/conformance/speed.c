/* Times of the functions of a unit of FMI 3.0 Co-Simulation, as a C importer sees them: the least of many short runs.

   cc -O2 -o speed fmu/conformance/speed.c -ldl
   speed LIBRARY TOKEN OUTPUT [INPUT LOW HIGH] [BOOLEAN_INPUT]

   LIBRARY is unpacked, OUTPUT and INPUT are value references of Float64. Prints nanoseconds of: a get of one value; a
   step of 0.1 s; set, step and get with an input that changes between LOW and HIGH at each step; instantiation with
   initialisation and the freeing of the instance. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1e9 + t.tv_nsec;
}

typedef void *(*Make)(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t,
                      void *, void *, void *);
static Make make;
static int (*enter)(void *, bool, double, double, bool, double), (*leave)(void *);
static int (*step)(void *, double, double, bool, bool *, bool *, bool *, double *);
static int (*get)(void *, const uint32_t *, size_t, double *, size_t);
static int (*set)(void *, const uint32_t *, size_t, const double *, size_t);
static int (*engage)(void *, const uint32_t *, size_t, const bool *, size_t);
static void (*release)(void *);
static const char *token;

static void must(int status) {
    if (status > 1) {
        fprintf(stderr, "a call answered %d\n", status);
        exit(1);
    }
}

static void *unit(void) {
    void *u = make("x", token, NULL, false, false, false, false, NULL, 0, NULL, NULL, NULL);
    if (!u) {
        fprintf(stderr, "no instance\n");
        exit(1);
    }
    must(enter(u, false, 0, 0, false, 0));
    must(leave(u));
    return u;
}

#define LEAST(runs, count, before, call)                         \
    ({                                                           \
        double least = 1e300;                                    \
        for (int run = 0; run < (runs); run++) {                 \
            before;                                              \
            double start = now();                                \
            for (int i = 0; i < (count); i++) { call; }          \
            double each = (now() - start) / (count);             \
            if (each < least) least = each;                      \
        }                                                        \
        least;                                                   \
    })

int main(int n, char **v) {
    if (n < 4) return fprintf(stderr, "speed LIBRARY TOKEN OUTPUT [INPUT LOW HIGH] [BOOLEAN_INPUT]\n"), 2;
    void *library = dlopen(v[1], RTLD_NOW);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 1;
    token = v[2];
    make = (Make)dlsym(library, "fmi3InstantiateCoSimulation");
    *(void **)&enter = dlsym(library, "fmi3EnterInitializationMode");
    *(void **)&leave = dlsym(library, "fmi3ExitInitializationMode");
    *(void **)&step = dlsym(library, "fmi3DoStep");
    *(void **)&get = dlsym(library, "fmi3GetFloat64");
    *(void **)&set = dlsym(library, "fmi3SetFloat64");
    *(void **)&engage = dlsym(library, "fmi3SetBoolean");
    *(void **)&release = dlsym(library, "fmi3FreeInstance");
    uint32_t output = strtoul(v[3], NULL, 0), input = n > 6 ? strtoul(v[4], NULL, 0) : 0;
    double low = n > 6 ? atof(v[5]) : 0, high = n > 6 ? atof(v[6]) : 0, value, last, time = 0;
    bool event, end, early, yes = true;

    void *u = NULL;
    double whole = LEAST(200, 5, , u = unit(); release(u));
    u = unit();
    if (n > 7) {
        uint32_t flag = strtoul(v[7], NULL, 0);
        must(engage(u, &flag, 1, &yes, 1));
    }
    must(step(u, 0, 0.1, false, &event, &end, &early, &last));
    double read = LEAST(2000, 200, , must(get(u, &output, 1, &value, 1)));
    release(u);
#define AGAIN                                                                 \
    if (u) release(u);                                                        \
    u = unit();                                                               \
    if (n > 7) {                                                              \
        uint32_t flag = strtoul(v[7], NULL, 0);                               \
        must(engage(u, &flag, 1, &yes, 1));                                   \
    }                                                                         \
    time = 0;
    u = NULL;
    double steps = LEAST(500, 20, AGAIN, must(step(u, time, 0.1, false, &event, &end, &early, &last)); time += 0.1);
    printf("get %.1f ns, step %.1f ns, ", read, steps);
    if (n > 6) {
        double all = LEAST(500, 20, AGAIN, value = i % 2 ? low : high; must(set(u, &input, 1, &value, 1));
                           must(step(u, time, 0.1, false, &event, &end, &early, &last)); time += 0.1;
                           must(get(u, &output, 1, &value, 1)));
        printf("set + step + get %.1f ns, ", all);
    }
    printf("instantiate + initialise + free %.2f us\n", whole / 1e3);
    return 0;
}
