/* The built-in functions that kernels call, for a compiler that is kept from reading the header with all of OpenCL's:
 * PoCL's clang reads 18,000 lines of overloads for each program, which takes six times as long as most kernels do
 * (builtin_options() in runtime/device/program_code.h). The declarations are OpenCL 1.2's, 6.12. A call of any other
 * built-in does not compile there. */
#ifndef GRADUS_SHARED_BUILTINS_H
#define GRADUS_SHARED_BUILTINS_H
#if defined(__OPENCL_VERSION__) && defined(GRADUS_DECLARE_BUILTINS)

#define GRADUS_BUILTIN __attribute__((overloadable, const))

size_t GRADUS_BUILTIN get_global_id(uint);
size_t GRADUS_BUILTIN get_global_size(uint);
size_t GRADUS_BUILTIN get_group_id(uint);
size_t GRADUS_BUILTIN get_local_id(uint);

real GRADUS_BUILTIN sqrt(real);
real GRADUS_BUILTIN fabs(real);
real GRADUS_BUILTIN floor(real);
/* Both signs, or arguments of the other would be converted without a word. */
int GRADUS_BUILTIN max(int, int);
uint GRADUS_BUILTIN max(uint, uint);
int GRADUS_BUILTIN min(int, int);
uint GRADUS_BUILTIN min(uint, uint);
uint GRADUS_BUILTIN mul_hi(uint, uint);

/* All items of a work-group must come to the same call. */
void __attribute__((overloadable, convergent, noduplicate)) barrier(uint flags);

/* Loads and stores of vectors at any address are defined here: PoCL's are made of halves, and what is computed with
 * those then is, too. */
#define GRADUS_ANYWHERE __attribute__((aligned(sizeof(real))))
#define GRADUS_VECTOR_FN static inline __attribute__((overloadable, always_inline))
#define GRADUS_LOAD_AND_STORE(memory, width, vector, anywhere)                                                         \
    GRADUS_VECTOR_FN vector vload##width(size_t i, const memory real *p) {                                             \
        return *(const memory anywhere *)(p + i * width);                                                              \
    }                                                                                                                  \
    GRADUS_VECTOR_FN void vstore##width(vector value, size_t i, memory real *p) {                                      \
        *(memory anywhere *)(p + i * width) = value;                                                                   \
    }
#define GRADUS_DEFINE_VECTORS(real8, real16)                                                                           \
    typedef real8 GRADUS_ANYWHERE real8_anywhere;                                                                      \
    typedef real16 GRADUS_ANYWHERE real16_anywhere;                                                                    \
    GRADUS_LOAD_AND_STORE(__global, 8, real8, real8_anywhere)                                                          \
    GRADUS_LOAD_AND_STORE(__global, 16, real16, real16_anywhere)                                                       \
    GRADUS_LOAD_AND_STORE(__local, 8, real8, real8_anywhere)
#ifdef GRADUS_DOUBLE
/* kernels/lib/approximation.h has no polynomials in double. */
real GRADUS_BUILTIN exp(real);
real GRADUS_BUILTIN log(real);
real GRADUS_BUILTIN sinpi(real);
real GRADUS_BUILTIN cospi(real);
real GRADUS_BUILTIN atan2(real, real);
real GRADUS_BUILTIN erf(real);
real GRADUS_BUILTIN erfc(real);
GRADUS_DEFINE_VECTORS(double8, double16)
#else
GRADUS_DEFINE_VECTORS(float8, float16)
#endif

#endif
#endif
