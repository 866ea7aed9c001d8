// What a file that is read may lead to: nothing. Each test first shows that the way out is one.
#include "robomill/io/system/sandbox.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <linux/seccomp.h>
#include <matio.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/system/child.hpp"
#include "robomill/io/system/descriptor.hpp"
#include "robomill/io/system/sanitized.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace sandbox_test {

namespace fs = std::filesystem;
using test::Folder;

constexpr double secret = 42.0;
constexpr hid_t by_default = 0;  // H5P_DEFAULT

bool opens(const fs::path& path, int flags = O_RDONLY) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

/// What f finds on a thread that is restricted, and whether the kernel can do that.
bool found_by_restricted(const FileRights& rights, const std::function<void()>& f) {
  bool restricted = false;
  std::thread([&] {
    restricted = restrict_files(rights);
    if (restricted) f();
  }).join();
  return restricted;
}

TEST(RestrictFiles, LeavesWhatIsNamed) {
  const Folder folder;
  fs::create_directories(folder.at("served/deep"));
  fs::create_directories(folder.at("read"));
  const fs::path outside = folder.file("outside.txt", "42");
  const fs::path one = folder.file("one.txt", "1"), beside = folder.file("one.txt.bak", "2");
  const fs::path own = folder.file("served/deep/own.txt", "own"), lent = folder.file("read/lent.txt", "lent");
  fs::create_symlink(outside, folder.at("served/link.txt"));
  const fs::path dots = folder.at("served") / ".." / "outside.txt";
  const bool known = found_by_restricted(
      {.readable = {folder.at("read"), one, folder.at("none")}, .writable = {folder.at("served")}}, [&] {
        EXPECT_TRUE(opens(own));
        EXPECT_TRUE(opens(own, O_WRONLY | O_TRUNC));
        EXPECT_TRUE(opens(folder.at("served/new.txt"), O_WRONLY | O_CREAT));
        EXPECT_EQ(::rename(folder.at("served/new.txt").c_str(), folder.at("served/deep/new.txt").c_str()), 0);
        EXPECT_EQ(::unlink(folder.at("served/deep/new.txt").c_str()), 0);
        EXPECT_TRUE(opens(lent));
        EXPECT_FALSE(opens(lent, O_WRONLY));
        EXPECT_FALSE(opens(folder.at("read/new.txt"), O_WRONLY | O_CREAT));
        EXPECT_TRUE(opens(one));
        for (const fs::path& path : {outside, beside, folder.at("served/link.txt"), dots, fs::path("/etc/passwd"),
                                     fs::path("/proc/self/root/etc/passwd"), folder.path()}) {
          EXPECT_FALSE(opens(path)) << path;
        }
        EXPECT_NE(::rename(own.c_str(), folder.at("away.txt").c_str()), 0);
        EXPECT_NE(::link(outside.c_str(), folder.at("served/hard.txt").c_str()), 0);
      });
  if (!known) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_TRUE(opens(outside));  // of the other threads nothing is taken
}

TEST(RestrictFiles, TakesTheNetworkWhereTheKernelCan) {
  bool here = false, there = false;
  const auto connect = [](bool& allowed) {
    errno = 0;
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket < 0) {  // denied already
      allowed = errno != EACCES;
      return;
    }
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(1);  // nobody listens there
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    errno = 0;
    static_cast<void>(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)));
    allowed = errno != EACCES;
    ::close(socket);
  };
  const bool known = found_by_restricted({}, [&] { connect(here); });
  if (!known) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_TRUE(here);
  found_by_restricted({.connects = false}, [&] { connect(there); });
  if (there) GTEST_SKIP() << "this kernel's Landlock knows no network";
}

TEST(RestrictFiles, LeavesNoWayToOtherProgramsWhereNothingConnects) {
  if (sanitized) GTEST_SKIP() << "sanitized builds look into programs";
  const Folder folder;
  // Somebody who listens at a path, as an agent of keys does.
  const std::string path = folder.at("agent.sock");
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof(address.sun_path));
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const Descriptor listens(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::bind(listens.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(::listen(listens.get(), 4), 0);
  const Descriptor early(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto connects = [&](int socket) {
    return ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  };
  const auto opens_socket = [](int domain, int type) {
    const Descriptor socket(::socket(domain, type | SOCK_CLOEXEC, 0));
    return socket.get() >= 0;
  };
  const Descriptor reachable(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_TRUE(connects(reachable.get()));
  ASSERT_TRUE(opens_socket(AF_INET, SOCK_DGRAM));
  bool filtered = false;
  found_by_restricted({.connects = false}, [&] {
    filtered = ::prctl(PR_GET_SECCOMP, 0, 0, 0, 0) == SECCOMP_MODE_FILTER;
    if (!filtered) return;
    EXPECT_FALSE(connects(early.get()));
    EXPECT_FALSE(opens_socket(AF_UNIX, SOCK_STREAM));
    EXPECT_FALSE(opens_socket(AF_INET, SOCK_DGRAM));
    EXPECT_NE(::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr), 0);
    std::array<int, 2> ends = {-1, -1};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);  // all else goes on
    for (const int one : ends) ::close(one);
  });
  if (!filtered) GTEST_SKIP() << "this kernel has no seccomp, or no Landlock";
}

TEST(RestrictFiles, SignalsItsOwnProgramsAlone) {
  const pid_t beside = ::fork();
  if (beside == 0) {
    for (;;) ::pause();
  }
  // In a process of its own, which has one below it.
  const pid_t restricted = ::fork();
  if (restricted == 0) {
    if (!restrict_files({})) ::_exit(2);
    const pid_t below = ::fork();
    if (below == 0) {
      for (;;) ::pause();
    }
    const bool ends_below = ::kill(below, SIGKILL) == 0;
    ::waitpid(below, nullptr, 0);
    ::_exit(!ends_below ? 1 : ::kill(beside, 0) == 0 ? 3 : 0);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(restricted, &status, 0), restricted);
  ::kill(beside, SIGKILL);
  ::waitpid(beside, nullptr, 0);
  if (WEXITSTATUS(status) >= 2) GTEST_SKIP() << "this kernel has no Landlock, or one that knows no signals";
  EXPECT_EQ(status, 0);
}

TEST(Child, OpensNoFile) {
  const Folder folder;
  const fs::path one = folder.file("one.txt", "1"), other = folder.file("other.txt", "2");
  ChildLimits memory = {.more_memory_bytes = std::size_t{1} << 26};
  const auto both = [&]() -> std::string {
    const int first = ::open(one.c_str(), O_RDONLY | O_CLOEXEC);
    const int second = ::open(other.c_str(), O_RDONLY | O_CLOEXEC);
    return std::string(first >= 0 ? "one" : "none") + (second >= 0 ? " other" : "");
  };
  EXPECT_EQ(run_in_child(memory, both), "none");
  const bool known = found_by_restricted({.readable = {folder.path()}}, [] {});
  memory.more_files = 1;
  EXPECT_EQ(run_in_child(memory, both), known ? "none" : "one");
  // What is in memory is lent.
  const Descriptor lent(::memfd_create("lent", MFD_CLOEXEC));
  const auto in_memory = [&]() -> std::string {
    return opens(fmt::format("/proc/self/fd/{}", lent.get())) ? "open" : "closed";
  };
  memory.lent = lent.get();
  EXPECT_EQ(run_in_child(memory, in_memory), "open");
  memory.more_files = 0;
  EXPECT_EQ(run_in_child(memory, in_memory), "closed");
}

TEST(RestrictToMoreFiles, NeedsNoLandlock) {
  const Folder folder;
  const fs::path one = folder.file("one.txt", "1"), other = folder.file("other.txt", "2");
  const pid_t child = ::fork();
  if (child == 0) {
    restrict_to_more_files(1);
    const int first = ::open(one.c_str(), O_RDONLY | O_CLOEXEC);
    const bool second = opens(other);
    ::close(first);
    ::_exit(first >= 0 && !second && opens(other) ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

/// A MAT file of version 7.3 with one variable of its own, opened by HDF5 to have more.
class Leading : public ::testing::Test {
 protected:
  Leading() {
    H5open();
    H5Eset_auto2(0, nullptr, nullptr);
    write("a.mat", "own", 1.0);
    write("theirs.mat", "theirs", secret);
    const std::vector<double> values(4, secret);
    std::string bytes(sizeof(double) * values.size(), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    folder_.file("secret.bin", bytes);
    file_ = H5Fopen(folder_.at("a.mat").c_str(), 1U, by_default);
    const std::array<hsize_t, 2> sizes = {1, 4};
    space_ = H5Screate_simple(2, sizes.data(), nullptr);
    layout_ = H5Pcreate(H5P_CLS_DATASET_CREATE_ID_g);
  }
  ~Leading() override {
    H5Pclose(layout_);
    H5Sclose(space_);
  }
  Leading(const Leading&) = delete;
  Leading& operator=(const Leading&) = delete;

  void write(const std::string& file, const char* name, double value) const {
    mat_t* mat = Mat_CreateVer(folder_.at(file).c_str(), nullptr, MAT_FT_MAT73);
    ASSERT_NE(mat, nullptr);
    std::array<std::size_t, 2> dims = {4, 1};
    std::array<double, 4> values = {};
    values.fill(value);
    matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(), values.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
    Mat_Close(mat);
  }
  /// A data set of the layout, named as a variable of MATLAB's.
  void add_data_set() const {
    const hid_t set = H5Dcreate2(file_, "stolen", H5T_IEEE_F64LE_g, space_, by_default, layout_, by_default);
    ASSERT_GE(set, 0);
    const hid_t text = H5Tcopy(H5T_C_S1_g);
    H5Tset_size(text, 6);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(set, "MATLAB_class", text, scalar, by_default, by_default);
    EXPECT_GE(H5Awrite(attribute, text, "double"), 0);
    H5Aclose(attribute);
    H5Sclose(scalar);
    H5Tclose(text);
    H5Dclose(set);
  }
  /// What a data set of the file has, as HDF5 alone sees it.
  [[nodiscard]] double first_value(const char* name) const {
    const hid_t set = H5Dopen2(file_, name, by_default);
    std::array<double, 4> values = {};
    H5Dread(set, H5T_IEEE_F64LE_g, 0, 0, by_default, values.data());
    H5Dclose(set);
    return values[0];
  }
  /// Whether HDF5 leads out of the child that reads MAT files, where nothing was checked before.
  [[nodiscard]] bool leads_out_of_child() const {
    std::string content = read_file(folder_.at("a.mat"));
    const auto said = run_in_child({.more_memory_bytes = std::size_t{1} << 26}, [&]() -> std::string {
      const hid_t access = H5Pcreate(H5P_CLS_FILE_ACCESS_ID_g);
      H5Pset_fapl_core(access, 1 << 16, 0);
      H5Pset_file_image(access, content.data(), content.size());
      const hid_t file = H5Fopen("/dev/null/image", 0U, access);
      const hid_t set = H5Dopen2(file, "stolen", by_default);
      std::array<double, 4> values = {};
      H5Dread(set, H5T_IEEE_F64LE_g, 0, 0, by_default, values.data());
      if (file < 0) return "unread";
      return values[0] == secret ? "out" : "in";
    });
    return said != "in";
  }
  /// … what read_mat says of it; empty: nothing.
  std::string said() {
    H5Fclose(file_);
    EXPECT_FALSE(leads_out_of_child());
    try {
      for (const MatVariable& variable : read_mat(folder_.at("a.mat"))) {
        const auto values = variable.re.reshaped();
        EXPECT_EQ(std::ranges::find(values, secret), values.end());
      }
      return {};
    } catch (const InvalidInput& error) {
      return error.what();
    }
  }
  [[nodiscard]] std::string rejection(const std::string& rule) const {
    return folder_.at("a.mat").string() + ": " + rule + ". Save the file anew, with all of its data in it";
  }

  Folder folder_;
  hid_t file_ = -1, space_ = -1, layout_ = -1;
};

TEST_F(Leading, ToExternalStorage) {
  ASSERT_GE(H5Pset_external(layout_, folder_.at("secret.bin").c_str(), 0, 32), 0);
  add_data_set();
  ASSERT_EQ(first_value("stolen"), secret);
  EXPECT_EQ(said(), rejection("stolen keeps its values in another file"));
}

TEST_F(Leading, ByAnExternalLink) {
  ASSERT_GE(H5Lcreate_external(folder_.at("theirs.mat").c_str(), "/theirs", file_, "stolen", by_default, by_default),
            0);
  ASSERT_EQ(first_value("stolen"), secret);
  EXPECT_EQ(said(), rejection("stolen is a link to another file"));
}

TEST_F(Leading, ToAVirtualDataSet) {
  const hid_t theirs = H5Fopen(folder_.at("theirs.mat").c_str(), 0U, by_default);
  const hid_t set = H5Dopen2(theirs, "theirs", by_default);
  const hid_t source = H5Dget_space(set);
  ASSERT_GE(H5Pset_virtual(layout_, space_, folder_.at("theirs.mat").c_str(), "/theirs", source), 0);
  H5Sclose(source);
  H5Dclose(set);
  H5Fclose(theirs);
  add_data_set();
  ASSERT_EQ(first_value("stolen"), secret);
  EXPECT_EQ(said(), rejection("stolen is a virtual data set, which is made of others'"));
}

// Within the file a link leads nowhere else; to another one it cannot.
TEST_F(Leading, ByASoftLink) {
  ASSERT_GE(
      H5Lcreate_soft((folder_.at("theirs.mat").string() + "/theirs").c_str(), file_, "stolen", by_default, by_default),
      0);
  EXPECT_EQ(said(), "");
}

// A filter that is no part of the library is code that it would look for and load.
TEST_F(Leading, ToAPlugIn) {
  constexpr int bzip2 = 307;
  constexpr unsigned optional_filter = 1;
  H5Pset_chunk(layout_, 2, std::array<hsize_t, 2>{1, 4}.data());
  ASSERT_GE(H5Pset_filter(layout_, bzip2, optional_filter, 0, nullptr), 0);
  add_data_set();
  EXPECT_EQ(said(), rejection("stolen needs the filter 307, which is a plug-in"));
}

// Deep in the file, where no variable is looked for.
TEST_F(Leading, FromAGroup) {
  const hid_t group = H5Gcreate2(file_, "deep", by_default, by_default, by_default);
  ASSERT_GE(H5Lcreate_external(folder_.at("theirs.mat").c_str(), "/theirs", group, "stolen", by_default, by_default),
            0);
  H5Gclose(group);
  EXPECT_EQ(said(), rejection("deep/stolen is a link to another file"));
}

TEST_F(Leading, ByItsOwnName) {
  H5Fclose(file_);
  const fs::path link = folder_.at("link.mat");
  fs::create_symlink(folder_.at("a.mat"), link);
  const std::vector<MatVariable> read = read_mat(link);  // a link that the user names is followed
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].name, "own");
}

}  // namespace sandbox_test
}  // namespace robomill::io
