// SPDX-License-Identifier: BSD-3-Clause
#include "gmsh_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#ifdef __linux__
#include <sys/personality.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "free_memory.hpp"

namespace roughmesh::detail {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_output = std::size_t{1} << 20;

// What of the caller's environment a gmsh may need to start: where programs and libraries are, also
// for the gmsh of a Python package.
std::vector<std::string> environment(const std::filesystem::path& home) {
  std::vector<std::string> variables = {"HOME=" + home.string(), "GMSH_HOME=" + home.string(),
                                        "TMPDIR=" + home.string(), "LC_ALL=C"};
  constexpr std::size_t most = 12;
  variables.reserve(most);
  for (const char* const name : {"PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "PYTHONPATH",
                                 "PYTHONHOME", "VIRTUAL_ENV", "PYTHONUSERBASE"})
    if (const char* const value = std::getenv(name))
      variables.push_back(fmt::format("{}={}", name, value));
  // Packages of the user are looked for below HOME, which is another one for the child.
  const char* const user = std::getenv("HOME");
  if (user != nullptr && std::getenv("PYTHONUSERBASE") == nullptr)
    variables.push_back(fmt::format("PYTHONUSERBASE={}/.local", user));
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> result;
  result.reserve(strings.size() + 1);
  for (std::string& string : strings) result.push_back(string.data());
  result.push_back(nullptr);
  return result;
}

[[noreturn]] void fail_to_start(const std::string& program, int error) {
  if (error == ENOENT)
    throw InputError(fmt::format("{}: not found; install it or give --gmsh PATH", program));
  throw InputError(fmt::format("{}: cannot be started: {}; give another --gmsh PATH", program,
                               std::generic_category().message(error)));
}

// Both ends are closed when it goes.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw InputError(
          "gmsh: no pipe can be made: too many open files; raise the limit (ulimit -n)");
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    ::close(ends_[0]);
    close_writer();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close_writer() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  std::array<int, 2> ends_ = {-1, -1};
};

// What the child begins with: its folder, no input, its output in the pipe, a process group of its
// own, and no signal blocked or ignored.
class Preparation {
 public:
  Preparation(const std::filesystem::path& folder, int output, const sigset_t& mask) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
    ::posix_spawnattr_init(&attributes_);
    sigset_t all;
    ::sigfillset(&all);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setsigmask(&attributes_, &mask);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~Preparation() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  Preparation(const Preparation&) = delete;
  Preparation& operator=(const Preparation&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

// Children that start while it lives have their memory at the same addresses each time: HXT orders
// points by address (seen in gmsh 4.8.4), so that elsewhere equal inputs give different meshes. A
// system that forbids it leaves the addresses random.
class FixedAddresses {
 public:
#ifdef __linux__
  FixedAddresses() : before_(::personality(query)) {
    if (before_ != -1) ::personality(static_cast<unsigned long>(before_) | ADDR_NO_RANDOMIZE);
  }
  ~FixedAddresses() {
    if (before_ != -1) ::personality(static_cast<unsigned long>(before_));
  }

 private:
  static constexpr unsigned long query = 0xffffffff;
  int before_;  // of this thread
#else
  FixedAddresses() = default;
  ~FixedAddresses() = default;
#endif

 public:
  FixedAddresses(const FixedAddresses&) = delete;
  FixedAddresses& operator=(const FixedAddresses&) = delete;
};

// A path with a slash is meant from the caller's folder, not from the child's.
std::string from_here(const std::string& program) {
  if (program.find('/') == std::string::npos) return program;
  return std::filesystem::absolute(program).string();
}

// A script may ask for any number of elements. The child has run for a moment before, which is too
// short to fill anything.
void limit_size(pid_t child, const GmshCall& call) {
  const std::optional<std::uint64_t> most = call.most_bytes ? call.most_bytes : free_memory();
  if (!most) return;
  constexpr std::uint64_t programs = std::uint64_t{4} << 30;  // address space, hardly used
  const rlimit memory{*most + programs, *most + programs}, file{*most, *most};
  ::prlimit(child, RLIMIT_AS, &memory, nullptr);
  ::prlimit(child, RLIMIT_FSIZE, &file, nullptr);
}

pid_t start(const ScratchFolder& folder, const GmshCall& call, int output) {
  std::vector<std::string> words = {from_here(call.program)};
  words.insert(words.end(), call.arguments.begin(), call.arguments.end());
  std::vector<std::string> variables = environment(folder.path());
  const std::vector<char*> argv = pointers(words);
  const std::vector<char*> envp = pointers(variables);
  // An interrupt between the start of the child and its entry would leave it running.
  sigset_t interrupts;
  sigset_t before;
  ::sigemptyset(&interrupts);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&interrupts, signal_number);
  ::pthread_sigmask(SIG_BLOCK, &interrupts, &before);
  pid_t child = 0;
  const Preparation preparation(call.folder.empty() ? folder.path() : call.folder, output, before);
  const FixedAddresses fixed_addresses;
  const int error = ::posix_spawnp(&child, argv[0], preparation.actions(), preparation.attributes(),
                                   argv.data(), envp.data());
  if (error == 0) {
    folder.set_child(child);
    limit_size(child, call);
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (error != 0) fail_to_start(call.program, error);
  return child;
}

// Kills the child's group and waits for the child when it goes, unless wait_until saw its end.
class Child {
 public:
  Child(const ScratchFolder& folder, pid_t id) : folder_(folder), id_(id) {}
  ~Child() {
    // Before the child is waited for: until then its number belongs to no other group.
    ::kill(-id_, SIGKILL);
    folder_.set_child(0);
    while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool has_ended() const {
    siginfo_t facts{};
    ::waitid(P_PID, static_cast<id_t>(id_), &facts, WEXITED | WNOHANG | WNOWAIT);
    return facts.si_pid == id_;
  }
  /// @pre has_ended()
  siginfo_t end() const {
    siginfo_t facts{};
    ::waitid(P_PID, static_cast<id_t>(id_), &facts, WEXITED | WNOWAIT);
    return facts;
  }

 private:
  const ScratchFolder& folder_;
  pid_t id_;
  int status_ = 0;
};

// Takes what is in the pipe; the child must never wait for us to read it.
void drain(int reader, std::string& output) {
  std::array<char, 65536> buffer;
  for (;;) {
    const ssize_t n = ::read(reader, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    const std::size_t room = most_output - output.size();
    output.append(buffer.data(), std::min(room, static_cast<std::size_t>(n)));
  }
}

// Returns whether the child ended in time.
bool wait_until(Clock::time_point deadline, const Child& child, int reader, std::string& output) {
  constexpr int pause = 20;  // ms: the end of the child is looked for so often
  while (Clock::now() < deadline) {
    const bool has_ended = child.has_ended();
    drain(reader, output);
    if (has_ended) return true;
    pollfd readable{.fd = reader, .events = POLLIN, .revents = 0};
    ::poll(&readable, 1, pause);
    // Closed by the child before its end: poll returns at once then.
    if ((readable.revents & POLLHUP) != 0) ::poll(nullptr, 0, pause);
  }
  return false;
}

std::string without_colours(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\033') {
      plain += text[i];
      continue;
    }
    while (i + 1 < text.size() && text[i] != 'm' && text[i] != '\n') ++i;
  }
  return plain;
}

// In whole seconds where it is a number of them.
[[noreturn]] void fail_late(const GmshCall& call) {
  throw InputError(fmt::format(
      "{}: not done after {:g} s and stopped; {}give it more time with --timeout", call.program,
      call.timeout, call.has_size ? "ask for a larger --mesh-size or " : ""));
}

[[noreturn]] void fail_crashed(const GmshCall& call, int signal_number, const std::string& output) {
  if (signal_number == SIGXFSZ)
    throw InputError(fmt::format(
        "{}: wrote a file larger than the memory that is free and was stopped; {}", call.program,
        call.has_size ? "ask for a larger --mesh-size" : "use a coarser mesh"));
  const std::string said = first_error(output);
  throw NumericalError(fmt::format("{}: crashed ({}){}{}; try {}a newer gmsh (--gmsh PATH)",
                                   call.program, ::strsignal(signal_number),
                                   said.empty() ? "" : " after: ", said,
                                   call.has_size ? "another --mesh-size or " : ""));
}

Clock::time_point deadline(double timeout) {
  if (!(timeout > 0)) throw InputError(fmt::format("timeout {}: must be above 0 seconds", timeout));
  constexpr double longest = 1e8;  // seconds, three years: what a time point surely holds
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(std::min(timeout, longest)));
}

// A line for a message: nothing that breaks it, at most 200 characters.
std::string one_line(std::string_view text) {
  constexpr std::size_t longest = 200;
  std::string line(text.substr(0, longest));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  return text.size() > longest ? line + "..." : line;
}

// Without the asterisks that OpenCASCADE frames its messages with.
std::string_view bare(std::string_view text) {
  const auto is_frame = [](char c) { return c == ' ' || c == '\r' || c == '\t' || c == '*'; };
  while (!text.empty() && is_frame(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_frame(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

GmshOutcome run_gmsh(const ScratchFolder& folder, const GmshCall& call) {
  const Clock::time_point end_of_time = deadline(call.timeout);
  Pipe pipe;
  const Child child(folder, start(folder, call, pipe.writer()));
  pipe.close_writer();
  GmshOutcome outcome;
  if (!wait_until(end_of_time, child, pipe.reader(), outcome.output)) fail_late(call);
  outcome.output = without_colours(outcome.output);
  const siginfo_t end = child.end();
  if (end.si_code != CLD_EXITED) fail_crashed(call, end.si_status, outcome.output);
  outcome.exit_status = end.si_status;
  return outcome;
}

std::string first_error(const std::string& output) {
  std::string_view first;
  for (std::string_view rest = output; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = bare(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    for (const std::string_view prefix : {"Error", "Fatal", "ERR "}) {
      if (!line.starts_with(prefix)) continue;
      const std::size_t colon = line.find(':');
      return one_line(colon == std::string_view::npos ? line : bare(line.substr(colon + 1)));
    }
    if (first.empty()) first = line;
  }
  return one_line(first);
}

}  // namespace roughmesh::detail
