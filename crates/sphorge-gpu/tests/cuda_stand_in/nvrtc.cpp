// A stand-in for NVIDIA's compiler: g++, for the processor. See README.md.

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>
#include <string>
#include <unistd.h>

namespace {

enum Result { SUCCESS = 0, INVALID_INPUT = 3, INVALID_OPTION = 5, COMPILATION = 6 };

struct Program {
    std::string text, log, code;
};

// Beside this library.
std::string prelude() {
    Dl_info info;
    dladdr(reinterpret_cast<void *>(&prelude), &info);
    return (std::filesystem::absolute(info.dli_fname).parent_path() / "prelude.h").string();
}

std::string cache() {
    const char *named = getenv("STAND_IN_CACHE");
    const std::string folder = named && *named ? named : "/tmp/sphorge-cuda-stand-in";
    std::filesystem::create_directories(folder);
    return folder;
}

std::string contents(const std::string &path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

Result give(const std::string &from, char *to) {
    memcpy(to, from.c_str(), from.size() + 1);
    return SUCCESS;
}

// Quotients and roots of cards that need not round them as the standard has it.
const char *const CARD_ROUNDING = R"(
static inline float card_quotient(float a, float b) {
    const float quotient = a / b, inverse = 1.0f / b;
    return std::isnormal(inverse) && std::isnormal(quotient) ? a * inverse : quotient;
}
static inline float card_root(float x) { return std::isnormal(x) ? x * rsqrtf(x) : sqrtf(x); }
)";

} // namespace

#define CALL extern "C" __attribute__((visibility("default"))) Result

CALL nvrtcVersion(int *major, int *minor) {
    *major = 13;
    *minor = 0;
    return SUCCESS;
}
extern "C" __attribute__((visibility("default"))) const char *nvrtcGetErrorString(Result) { return "an error of the stand-in"; }
CALL nvrtcGetNumSupportedArchs(int *count) {
    *count = 1;
    return SUCCESS;
}
CALL nvrtcGetSupportedArchs(int *known) {
    *known = 90;
    return SUCCESS;
}
CALL nvrtcCreateProgram(Program **program, const char *text, const char *, int headers, const char *const *, const char *const *) {
    if (headers) {
        return INVALID_INPUT;
    }
    *program = new Program{text, "", ""};
    return SUCCESS;
}
CALL nvrtcCompileProgram(Program *program, int count, const char *const *options) {
    for (int k = 0; k < count; ++k) {
        const std::string option = options[k];
        if (option != "--gpu-architecture=sm_90" && option != "--fmad=false" && option != "--prec-div=false" && option != "--prec-sqrt=false") {
            program->log = "option that the stand-in does not know: " + option;
            return INVALID_OPTION;
        }
    }
    std::string text = program->text;
    const char *rounding = getenv("STAND_IN_ROUNDING");
    if (rounding && std::string(rounding) == "card") {
        // Every quotient is a line of its own.
        text = std::regex_replace(text, std::regex("= (\\S+) / (\\S+);"), "= card_quotient($1, $2);");
        text = CARD_ROUNDING + std::regex_replace(text, std::regex("\\bsqrtf\\("), "card_root(");
    }
    std::string source = "#include \"" + prelude() + "\"\n" + text;
    // An entry for each kernel that takes its arguments one by one from an array.
    const std::regex kernel("extern \"C\" __global__ void (\\w+)\\(");
    for (std::sregex_iterator found(program->text.begin(), program->text.end(), kernel), end; found != end; ++found) {
        const std::string name = (*found)[1];
        source += "extern \"C\" void stand_in_" + name + "_launch(void **arguments, unsigned blocks, unsigned threads) { stand_in_run(" + name +
                  ", arguments, blocks, threads); }\nextern \"C\" int stand_in_" + name + "_arguments = stand_in_count(" + name + ");\n";
    }
    source = std::regex_replace(source, std::regex("extern \"C\" __global__"), "__global__");
    const auto name = std::to_string(std::hash<std::string>()(source + contents(prelude())));
    // Several threads and processes may compile the same text at once: the last to be done stays.
    static std::atomic<int> number;
    const std::string stem = cache() + "/" + name, own = stem + "-" + std::to_string(getpid()) + "-" + std::to_string(number++);
    if (!std::filesystem::exists(stem + ".so")) {
        std::ofstream(own + ".cpp") << source;
        const std::string command = "g++ -std=c++17 -O1 -ffp-contract=off -fno-math-errno -mfma -w -shared -fPIC -o " + own + ".so " + own + ".cpp 2> " + own + ".log";
        const int failed = system(command.c_str());
        program->log = contents(own + ".log");
        std::filesystem::remove(own + ".log");
        if (failed) {
            return COMPILATION;
        }
        std::filesystem::remove(own + ".cpp");
        std::filesystem::rename(own + ".so", stem + ".so");
    }
    program->code = stem + ".so";
    return SUCCESS;
}
CALL nvrtcGetCUBINSize(Program *program, size_t *bytes) {
    *bytes = program->code.size() + 1;
    return SUCCESS;
}
CALL nvrtcGetCUBIN(Program *program, char *code) { return give(program->code, code); }
CALL nvrtcGetPTXSize(Program *program, size_t *bytes) { return nvrtcGetCUBINSize(program, bytes); }
CALL nvrtcGetPTX(Program *program, char *code) { return give(program->code, code); }
CALL nvrtcGetProgramLogSize(Program *program, size_t *bytes) {
    *bytes = program->log.size() + 1;
    return SUCCESS;
}
CALL nvrtcGetProgramLog(Program *program, char *log) { return give(program->log, log); }
CALL nvrtcDestroyProgram(Program **program) {
    delete *program;
    *program = nullptr;
    return SUCCESS;
}
