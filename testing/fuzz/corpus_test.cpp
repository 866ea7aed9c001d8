// The saved inputs of every reader, in every build: what a fuzzer found stays mended.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "testing/fuzz/reader.hpp"

namespace robomill {
namespace fuzz_corpus_test {

const std::filesystem::path corpus = std::filesystem::path(ROBOMILL_SOURCE_DIR) / "testing/fuzz/corpus";

class FuzzCorpus : public testing::TestWithParam<fuzz::Reader> {};

TEST_P(FuzzCorpus, IsAcceptedOrRejected) {
  std::size_t inputs = 0;
  for (const auto& file : std::filesystem::directory_iterator(corpus / GetParam().name)) {
    SCOPED_TRACE(file.path());
    std::ifstream stream(file.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_NO_THROW(GetParam().read(bytes));
    ++inputs;
  }
  EXPECT_GT(inputs, 0U);
  EXPECT_NO_THROW(GetParam().read({}));
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzCorpus, testing::ValuesIn(fuzz::readers().begin(), fuzz::readers().end()),
                         [](const auto& reader) { return std::string(reader.param.name); });

}  // namespace fuzz_corpus_test
}  // namespace robomill
