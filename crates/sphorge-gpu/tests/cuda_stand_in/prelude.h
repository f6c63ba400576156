// What kernels in CUDA C++ use of the language, for a processor.
#include <cmath>
#include <utility>

#define __global__ static
#define __restrict__ __restrict

struct stand_in_place {
    unsigned x, y, z;
};
static stand_in_place blockIdx, blockDim, threadIdx;

static inline unsigned atomicAdd(unsigned *at, unsigned value) {
    const unsigned before = *at;
    *at += value;
    return before;
}
static inline float rsqrtf(float x) { return 1.0f / sqrtf(x); }

// Every thread of every block of a launch, in order.
template <class... Arguments, size_t... Index>
static void stand_in_run(void (*kernel)(Arguments...), void **arguments, unsigned blocks, unsigned threads, std::index_sequence<Index...>) {
    blockDim = {threads, 1, 1};
    for (unsigned block = 0; block < blocks; ++block) {
        for (unsigned thread = 0; thread < threads; ++thread) {
            blockIdx = {block, 0, 0};
            threadIdx = {thread, 0, 0};
            kernel(*static_cast<Arguments *>(arguments[Index])...);
        }
    }
}
template <class... Arguments>
static void stand_in_run(void (*kernel)(Arguments...), void **arguments, unsigned blocks, unsigned threads) {
    stand_in_run(kernel, arguments, blocks, threads, std::index_sequence_for<Arguments...>());
}
template <class... Arguments>
static constexpr int stand_in_count(void (*)(Arguments...)) { return sizeof...(Arguments); }
