// A stand-in for NVIDIA's driver that runs on the processor: see README.md.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

enum Result {
    SUCCESS = 0,
    INVALID_VALUE = 1,
    OUT_OF_MEMORY = 2,
    NOT_INITIALIZED = 3,
    NO_DEVICE = 100,
    INVALID_DEVICE = 101,
    INVALID_IMAGE = 200,
    INVALID_CONTEXT = 201,
    NOT_FOUND = 500,
    ILLEGAL_ADDRESS = 700,
};

struct Context {
    int retained = 0;
};
struct Stream {};
struct Event {
    std::chrono::steady_clock::time_point at;
    // Copies to the host that were asked for before it.
    long copies = 0;
};
// A copy to the host that is delivered when somebody waits for it: until then the target holds what is no number.
struct Copy {
    long number;
    void *to;
    std::vector<char> bytes;
};
struct Module {
    void *library;
};
// What a compiled kernel has beside its code: see nvrtc.cpp.
struct Function {
    void (*launch)(void **, unsigned, unsigned);
    int arguments;
};

std::recursive_mutex lock;
std::vector<Copy> under_way;
long copies = 0;

void deliver(long until) {
    for (auto copy = under_way.begin(); copy != under_way.end();) {
        if (copy->number > until) {
            ++copy;
            continue;
        }
        memcpy(copy->to, copy->bytes.data(), copy->bytes.size());
        copy = under_way.erase(copy);
    }
}
bool is_started = false;
Context context;
thread_local Context *current = nullptr;
std::map<uintptr_t, size_t> blocks;
std::set<Stream *> streams;
size_t taken = 0;
long launches = 0;
// Errors of a launch stay.
Result sticky = SUCCESS;

long variable(const char *name, long otherwise) {
    const char *text = getenv(name);
    return text && *text ? atol(text) : otherwise;
}
long cards() { return variable("STAND_IN_CARDS", 1); }
size_t memory() { return size_t(variable("STAND_IN_MEMORY", 4L << 30)); }

// The bytes from a place to the end of its block; none where it is in none.
size_t room(uintptr_t place) {
    auto after = blocks.upper_bound(place);
    if (after == blocks.begin()) {
        return 0;
    }
    --after;
    const uintptr_t end = after->first + after->second;
    return place < end ? end - place : 0;
}

Result ready() {
    if (!is_started) {
        return NOT_INITIALIZED;
    }
    return current && current->retained ? sticky : INVALID_CONTEXT;
}

} // namespace

#define CALL extern "C" __attribute__((visibility("default"))) Result
#define LOCK std::lock_guard<std::recursive_mutex> guard(lock)
#define NEEDS_CONTEXT                                                                                                                                          \
    LOCK;                                                                                                                                                      \
    if (const Result why = ready()) {                                                                                                                          \
        return why;                                                                                                                                            \
    }

CALL cuInit(unsigned) {
    is_started = true;
    return cards() > 0 ? SUCCESS : NO_DEVICE;
}
CALL cuDriverGetVersion(int *version) {
    *version = 13000;
    return SUCCESS;
}
// NVIDIA's own compiler asks for a table of its cache, and does without one, but not without this call.
CALL cuGetExportTable(const void **table, const void *) {
    *table = nullptr;
    return NOT_FOUND;
}
CALL cuGetErrorName(Result error, const char **text) {
    switch (error) {
    case SUCCESS: *text = "CUDA_SUCCESS"; return SUCCESS;
    case INVALID_VALUE: *text = "CUDA_ERROR_INVALID_VALUE"; return SUCCESS;
    case OUT_OF_MEMORY: *text = "CUDA_ERROR_OUT_OF_MEMORY"; return SUCCESS;
    case NOT_INITIALIZED: *text = "CUDA_ERROR_NOT_INITIALIZED"; return SUCCESS;
    case NO_DEVICE: *text = "CUDA_ERROR_NO_DEVICE"; return SUCCESS;
    case INVALID_DEVICE: *text = "CUDA_ERROR_INVALID_DEVICE"; return SUCCESS;
    case INVALID_IMAGE: *text = "CUDA_ERROR_INVALID_IMAGE"; return SUCCESS;
    case INVALID_CONTEXT: *text = "CUDA_ERROR_INVALID_CONTEXT"; return SUCCESS;
    case NOT_FOUND: *text = "CUDA_ERROR_NOT_FOUND"; return SUCCESS;
    case ILLEGAL_ADDRESS: *text = "CUDA_ERROR_ILLEGAL_ADDRESS"; return SUCCESS;
    }
    return INVALID_VALUE;
}
CALL cuGetErrorString(Result error, const char **text) {
    *text = "an error of the stand-in";
    return error == SUCCESS ? INVALID_VALUE : SUCCESS;
}

CALL cuDeviceGetCount(int *count) {
    *count = int(cards());
    return is_started ? SUCCESS : NOT_INITIALIZED;
}
CALL cuDeviceGet(int *device, int number) {
    *device = number;
    return number < cards() ? SUCCESS : INVALID_DEVICE;
}
CALL cuDeviceGetName(char *name, int length, int device) {
    snprintf(name, size_t(length), "stand-in %d (the processor)", device);
    return SUCCESS;
}
CALL cuDeviceTotalMem_v2(size_t *bytes, int) {
    *bytes = memory();
    return SUCCESS;
}
CALL cuDeviceGetAttribute(int *value, int which, int) {
    // Compute capability 9.0.
    *value = which == 75 ? 9 : 0;
    return which == 75 || which == 76 ? SUCCESS : INVALID_VALUE;
}
CALL cuDevicePrimaryCtxRetain(Context **of, int) {
    LOCK;
    ++context.retained;
    *of = &context;
    return SUCCESS;
}
CALL cuDevicePrimaryCtxRelease_v2(int) {
    LOCK;
    return --context.retained < 0 ? INVALID_CONTEXT : SUCCESS;
}
CALL cuCtxSetCurrent(Context *of) {
    current = of;
    return SUCCESS;
}

CALL cuStreamCreate(Stream **stream, unsigned) {
    NEEDS_CONTEXT
    *stream = new Stream;
    streams.insert(*stream);
    return SUCCESS;
}
CALL cuStreamSynchronize(Stream *stream) {
    NEEDS_CONTEXT
    deliver(copies);
    return streams.count(stream) ? SUCCESS : INVALID_VALUE;
}
CALL cuStreamDestroy_v2(Stream *stream) {
    NEEDS_CONTEXT
    streams.erase(stream);
    delete stream;
    return SUCCESS;
}

CALL cuMemGetInfo_v2(size_t *free_bytes, size_t *total) {
    NEEDS_CONTEXT
    *total = memory();
    *free_bytes = memory() - taken;
    return SUCCESS;
}
CALL cuMemAlloc_v2(uintptr_t *pointer, size_t bytes) {
    NEEDS_CONTEXT
    if (bytes == 0) {
        return INVALID_VALUE;
    }
    if (taken + bytes > memory()) {
        return OUT_OF_MEMORY;
    }
    void *block = malloc(bytes);
    if (!block) {
        return OUT_OF_MEMORY;
    }
    // What is not set shows.
    memset(block, 0x7f, bytes);
    *pointer = reinterpret_cast<uintptr_t>(block);
    blocks[*pointer] = bytes;
    taken += bytes;
    return SUCCESS;
}
CALL cuMemFree_v2(uintptr_t pointer) {
    LOCK;
    const auto block = blocks.find(pointer);
    if (block == blocks.end()) {
        return INVALID_VALUE;
    }
    taken -= block->second;
    blocks.erase(block);
    free(reinterpret_cast<void *>(pointer));
    return SUCCESS;
}
CALL cuMemsetD8Async(uintptr_t to, unsigned char value, size_t bytes, Stream *stream) {
    NEEDS_CONTEXT
    if (room(to) < bytes || !streams.count(stream)) {
        return INVALID_VALUE;
    }
    memset(reinterpret_cast<void *>(to), value, bytes);
    return SUCCESS;
}
CALL cuMemcpyHtoDAsync_v2(uintptr_t to, const void *from, size_t bytes, Stream *stream) {
    NEEDS_CONTEXT
    if (room(to) < bytes || !streams.count(stream)) {
        return INVALID_VALUE;
    }
    memcpy(reinterpret_cast<void *>(to), from, bytes);
    return SUCCESS;
}
CALL cuMemcpyDtoHAsync_v2(void *to, uintptr_t from, size_t bytes, Stream *stream) {
    NEEDS_CONTEXT
    if (room(from) < bytes || !streams.count(stream)) {
        return INVALID_VALUE;
    }
    const char *source = reinterpret_cast<const char *>(from);
    under_way.push_back({++copies, to, std::vector<char>(source, source + bytes)});
    memset(to, 0xff, bytes);
    return SUCCESS;
}

CALL cuMemHostAlloc(void **pointer, size_t bytes, unsigned) {
    NEEDS_CONTEXT
    *pointer = malloc(bytes);
    return *pointer ? SUCCESS : OUT_OF_MEMORY;
}
CALL cuMemFreeHost(void *pointer) {
    NEEDS_CONTEXT
    free(pointer);
    return SUCCESS;
}

CALL cuModuleLoadData(Module **module, const char *image) {
    NEEDS_CONTEXT
    // The image of nvrtc.cpp is the path of a library.
    void *library = dlopen(image, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "stand-in: %s\n", dlerror());
        return INVALID_IMAGE;
    }
    *module = new Module{library};
    return SUCCESS;
}
CALL cuModuleGetFunction(Function **function, Module *module, const char *name) {
    NEEDS_CONTEXT
    const std::string prefix = std::string("stand_in_") + name;
    void *launch = dlsym(module->library, (prefix + "_launch").c_str());
    void *arguments = dlsym(module->library, (prefix + "_arguments").c_str());
    if (!launch || !arguments) {
        return NOT_FOUND;
    }
    // Few, and as long as the program.
    *function = new Function{reinterpret_cast<void (*)(void **, unsigned, unsigned)>(launch), *static_cast<int *>(arguments)};
    return SUCCESS;
}
CALL cuModuleUnload(Module *module) {
    LOCK;
    dlclose(module->library);
    delete module;
    return SUCCESS;
}
CALL cuLaunchKernel(Function *function, unsigned x, unsigned y, unsigned z, unsigned threads, unsigned threads_y, unsigned threads_z, unsigned shared,
                    Stream *stream, void **arguments, void **extra) {
    NEEDS_CONTEXT
    if (x == 0 || y != 1 || z != 1 || threads == 0 || threads > 1024 || threads_y != 1 || threads_z != 1 || shared || extra || !streams.count(stream)) {
        return INVALID_VALUE;
    }
    const long last = variable("STAND_IN_LOST_AFTER", 0);
    if (last && ++launches > last) {
        return sticky = ILLEGAL_ADDRESS;
    }
    // The last is the number of threads.
    for (int k = 0; k + 1 < function->arguments; ++k) {
        if (!room(*static_cast<uintptr_t *>(arguments[k]))) {
            return sticky = ILLEGAL_ADDRESS;
        }
    }
    function->launch(arguments, x, threads);
    return SUCCESS;
}

CALL cuEventCreate(Event **event, unsigned) {
    NEEDS_CONTEXT
    *event = new Event;
    return SUCCESS;
}
CALL cuEventRecord(Event *event, Stream *stream) {
    NEEDS_CONTEXT
    event->at = std::chrono::steady_clock::now();
    event->copies = copies;
    return streams.count(stream) ? SUCCESS : INVALID_VALUE;
}
CALL cuEventSynchronize(Event *event) {
    NEEDS_CONTEXT
    deliver(event->copies);
    return SUCCESS;
}
CALL cuEventElapsedTime(float *milliseconds, Event *start, Event *end) {
    NEEDS_CONTEXT
    *milliseconds = std::chrono::duration<float, std::milli>(end->at - start->at).count();
    return SUCCESS;
}
CALL cuEventDestroy_v2(Event *event) {
    LOCK;
    delete event;
    return SUCCESS;
}
