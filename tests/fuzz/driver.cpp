// SPDX-License-Identifier: Apache-2.0
// Deterministic fuzzing by mutation of valid files, for CI and systems without libFuzzer.
//   fuzz_driver TARGET RUNS           performs runs 0 to RUNS - 1; prints the run that crashes or takes too long
//   fuzz_driver TARGET RUNS ONLY      performs one run and writes its input to fuzz-TARGET-ONLY.bin in this folder
//   fuzz_driver TARGET seeds FOLDER   writes the seed files for libFuzzer
#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "support/memory_limit.h"
#include "targets.h"

namespace fathom::fuzz {

namespace {

constexpr unsigned longest_run_s = 20;     // limit of CPU time, which does not depend on other programs
constexpr unsigned longest_wait_s = 3600;  // ends a run that waits forever

using Random = std::mt19937_64;

/// Uniform number below n with the same result in all standard libraries.
std::size_t below(Random& random, std::size_t n)
{
    return n == 0 ? 0 : std::size_t(random() % n);
}

void flip_bits(std::string& file, Random& random)
{
    for (std::size_t n = 1 + below(random, 8); n > 0 && !file.empty(); --n)
        file[below(random, file.size())] ^= char(1 << below(random, 8));
}

void put_number(std::string& file, Random& random)
{
    static constexpr std::uint64_t numbers[] = {0,
                                                1,
                                                0x7f,
                                                0xff,
                                                0x7fff,
                                                0xffff,
                                                0x7fffffff,
                                                0x80000000,
                                                0xffffffff,
                                                0x7f800000,
                                                0x7fc00000,
                                                0x7f7fffff,
                                                ~std::uint64_t(0),
                                                1ull << 62};
    const std::uint64_t number = numbers[below(random, std::size(numbers))];
    const std::size_t size = std::size_t(1) << below(random, 4);
    if (file.size() < size) return;
    std::memcpy(&file[below(random, file.size() - size + 1)], &number, size);
}

void put_word(std::string& file, Random& random)
{
    static constexpr const char* words[] = {
        "-1",   "0",    "1e38",       "-1e308", "1e-320", "nan",     "99999999999", "2147483648", "null",    "[",
        "]",    "{",    "}",          "\"",     ",",      "\n",      " ",           "/",          "//",      "\\",
        "\\\n", "true", "4294967295", "0.5",    "[[[[",   "../../a", "-",           ".",          "\xff\xfe"};
    file.insert(below(random, file.size() + 1), words[below(random, std::size(words))]);
}

/// Replaces a number in the text by another.
void change_digits(std::string& file, Random& random)
{
    const std::size_t start = file.find_first_of("0123456789", below(random, file.size() + 1));
    if (start == std::string::npos) return;
    const std::size_t end = file.find_first_not_of("0123456789.", start);
    static constexpr const char* others[] = {"0",       "-1",         "7",    "255", "65536",
                                             "1000000", "4000000000", "1e30", "0.1", "18446744073709551615"};
    file.replace(start, (end == std::string::npos ? file.size() : end) - start,
                 others[below(random, std::size(others))]);
}

void cut(std::string& file, Random& random)
{
    file.resize(below(random, file.size() + 1));
}

void leave_out(std::string& file, Random& random)
{
    const std::size_t at = below(random, file.size() + 1);
    file.erase(at, 1 + below(random, 40));
}

void repeat(std::string& file, Random& random)
{
    const std::size_t at = below(random, file.size() + 1);
    const std::string piece = file.substr(at, 1 + below(random, 60));
    file.insert(below(random, file.size() + 1), piece);
}

std::string mutated(const std::vector<std::string>& seeds, std::uint64_t run)
{
    Random random(run);
    std::string file = seeds[below(random, seeds.size())];
    constexpr void (*mistakes[])(std::string&, Random&) = {flip_bits, put_number, put_word, change_digits,
                                                           cut,       leave_out,  repeat,   change_digits};
    for (std::size_t n = 1 + below(random, 6); n > 0; --n) mistakes[below(random, std::size(mistakes))](file, random);
    return file;
}

char place[100];

void on_signal(int)
{
    [[maybe_unused]] const ssize_t n = write(STDERR_FILENO, place, std::strlen(place));
    _exit(1);
}

void run_once(const Target& target, const std::vector<std::string>& seeds, std::uint64_t run)
{
    std::snprintf(place, sizeof place, "%s: run %llu crashes or takes too long\n", std::string(target.name).c_str(),
                  static_cast<unsigned long long>(run));
    const itimerval limit{{0, 0}, {longest_run_s, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    alarm(longest_wait_s);
    target.run(mutated(seeds, run));
}

const Target* find(const std::string& name)
{
    for (const Target& target : targets())
        if (target.name == name) return &target;
    return nullptr;
}

void write_file(const std::filesystem::path& file, const std::string& bytes)
{
    std::ofstream(file, std::ios::binary) << bytes;
}

int run(int argc, char** argv)
{
    const Target* const target = argc < 3 ? nullptr : find(argv[1]);
    if (!target) {
        std::fprintf(stderr, "usage: fuzz_driver TARGET RUNS [ONLY] | TARGET seeds FOLDER; targets:");
        for (const Target& t : targets()) std::fprintf(stderr, " %s", std::string(t.name).c_str());
        std::fprintf(stderr, "\n");
        return 2;
    }
    const std::vector<std::string> seeds = target->seeds();
    if (std::strcmp(argv[2], "seeds") == 0 && argc > 3) {
        for (std::size_t i = 0; i < seeds.size(); ++i)
            write_file(std::filesystem::path(argv[3]) / (argv[1] + std::to_string(i)), seeds[i]);
        return 0;
    }
    if (argc > 3) {
        const std::uint64_t only = std::strtoull(argv[3], nullptr, 10);
        write_file(std::string("fuzz-") + argv[1] + '-' + argv[3] + ".bin", mutated(seeds, only));
        run_once(*target, seeds, only);
        return 0;
    }
    const test::MemoryLimit memory(rlim_t(4) << 30);
    for (int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGALRM, SIGPROF}) std::signal(signal, on_signal);
    // Undamaged seeds must be read without an error.
    for (const std::string& seed : seeds) target->run(seed);
    const std::uint64_t runs = std::strtoull(argv[2], nullptr, 10);
    for (std::uint64_t i = 0; i < runs; ++i) run_once(*target, seeds, i);
    std::printf("%s: %llu runs\n", argv[1], static_cast<unsigned long long>(runs));
    return 0;
}

}  // namespace

}  // namespace fathom::fuzz

int main(int argc, char** argv)
{
    try {
        return fathom::fuzz::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%sit threw: %s\n", fathom::fuzz::place, error.what());
        return 1;
    }
}
