#include "robomill/io/records/tree/file_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/tree/tree_words.hpp"
#include "robomill/io/records/units_agree.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

bool is_number(const FileNode& node) {
  return node.kind == FileNode::Kind::numbers && node.columns.size() == 1 && node.columns.front().size() == 1;
}

/// What can be a channel, or is named as one that cannot.
bool is_signal(const FileNode& node) {
  return node.kind == FileNode::Kind::numbers && (!node.fault.empty() || (!node.columns.empty() && !is_number(node)));
}

/// One text, or several parted by commas or semicolons where there are to be so many.
std::vector<std::string> texts_of(const FileNode& node, std::size_t count) {
  if (node.texts.size() != 1 || count < 2) return node.texts;
  const char separator = node.texts.front().find(';') != std::string::npos ? ';' : ',';
  std::vector<std::string> out = {{}};
  for (const char letter : node.texts.front()) {
    if (letter == separator) {
      out.emplace_back();
    } else {
      out.back() += letter;
    }
  }
  for (std::string& text : out) text = std::string(trimmed(text));
  return out.size() == count ? out : node.texts;
}

/// Times of a file, as far as they can be those of its channels.
struct TreeTimes {
  std::size_t node = none;
  Eigen::Index samples = 0;
  double rate_hz = 0.0, start_s = 0.0;
  std::string fault = {};  ///< why they give no rate
};

class TreeReader {
 public:
  TreeReader(FileTree tree, const std::filesystem::path& path, const std::string& time)
      : tree_(std::move(tree)), nodes_(tree_.nodes), file_(path.string()), own_time_(time), children_(nodes_.size()) {
    record_.file = path;
    record_.units_by = "the file";
    record_.notes = std::move(tree_.notes);
    for (std::size_t i = 1; i < nodes_.size(); ++i) children_[nodes_[i].parent].push_back(i);
  }

  Record read() {
    for (std::size_t i = 1; i < nodes_.size(); ++i) convert_times(i);
    for (std::size_t i = 1; i < nodes_.size(); ++i) add_channels(i);
    name_twins_by_path();
    require_agreement();
    const ChannelsTogether taken = channels_together(channels_, file_, ChannelLengths::any);
    take_channels(record_, channels_, taken);
    for (const std::size_t place : taken.places) {
      const auto [node, column] = places_[place];
      record_.columns.push_back(std::move(nodes_[node].columns[column]));
      note_scale(node);
    }
    return std::move(record_);
  }

 private:
  /// Its text of a kind that is_word knows; of several the first.
  template <class IsWord>
  [[nodiscard]] const FileNode* text_in(std::size_t group, const IsWord& is_word) const {
    for (const std::size_t child : children_[group]) {
      const FileNode& node = nodes_[child];
      if (node.kind == FileNode::Kind::texts && !node.texts.empty() && is_word(node.key)) return &node;
    }
    return nullptr;
  }

  [[nodiscard]] bool is_only_signal(std::size_t place) const {
    return std::ranges::none_of(children_[nodes_[place].parent], [&](std::size_t other) {
      return other != place && is_signal(nodes_[other]) && time_word(nodes_[other].key) == 0.0;
    });
  }

  /// What the file says the units of a node's columns are; none, one for all, or one each.
  [[nodiscard]] std::vector<std::string> units_of(std::size_t place) const {
    const FileNode& node = nodes_[place];
    const std::size_t count = node.columns.size();
    if (const FileNode* own = text_in(place, is_unit_word)) return texts_of(*own, count);
    const std::string word = plain_word(node.key);
    const auto is_of_it = [&word](std::string_view key) {
      const std::string other = plain_word(key);
      return other == word + "unit" || other == word + "units";
    };
    if (const FileNode* beside = text_in(node.parent, is_of_it)) return texts_of(*beside, count);
    const bool is_values = is_values_word(node.key);
    for (const std::size_t child : children_[node.parent]) {  // as Testlab writes it: y_values.quantity.label
      if (!is_values || plain_word(nodes_[child].key) != "quantity") continue;
      if (const FileNode* label = text_in(child, is_label_word)) return label->texts;
    }
    const bool is_time = time_word(node.key) > 0.0;
    if (is_time || (!is_values && !is_only_signal(place))) return {};
    const FileNode* all = text_in(node.parent, is_unit_word);
    return all == nullptr ? std::vector<std::string>() : texts_of(*all, count);
  }

  /// Times come in s, whatever the file has them in.
  void convert_times(std::size_t place) {
    FileNode& node = nodes_[place];
    if (!is_signal(node) || !node.fault.empty() || node.columns.size() != 1) return;
    double s = time_word(node.key);
    if (s == 0.0) return;
    const std::vector<std::string> units = units_of(place);
    if (!units.empty()) s = seconds_in(units.front());
    if (s == 0.0) {
      record_.notes.push_back(
          fmt::format("{}: {} is in {}, and does not count as the time", file_, node.name, units.front()));
      return;
    }
    if (s != 1.0) {
      node.columns.front() *= s;
      record_.notes.push_back(fmt::format("{}: {} is converted to s", file_, node.name));
    }
    in_s_.push_back(place);
    TreeTimes times{.node = place, .samples = node.columns.front().size(), .start_s = node.columns.front()(0)};
    if (rounded_sample_rate_of(node.columns.front()) > 0.0) {
      record_.notes.push_back(fmt::format("{}: column {} is rounded and does not count as the time", file_, node.name));
      return;
    }
    try {
      times.rate_hz = round_15(sample_rate_of(node.columns.front(), node.name));
    } catch (const InvalidInput& error) {
      times.fault = fmt::format("over {}: {}", node.name, error.parts().rule);
    }
    times_.push_back(std::move(times));
  }

  /// The rate that a group or data set states as a number; 0: none.
  [[nodiscard]] double stated_rate(std::size_t group) const {
    for (const std::size_t child : children_[group]) {
      const FileNode& node = nodes_[child];
      const RateWord word = rate_word(node.key);
      if (word.kind == RateWord::Kind::none) continue;
      std::optional<double> value;
      if (is_number(node) && node.fault.empty()) value = node.columns.front()(0);
      if (node.kind == FileNode::Kind::texts && node.texts.size() == 1) value = parse_number(trimmed(node.texts[0]));
      if (!value || !std::isfinite(*value) || *value <= 0.0) continue;
      double factor = word.factor;
      if (const FileNode* unit = text_in(child, is_unit_word)) {
        const std::string text = lowered(trimmed(unit->texts.front()));
        if (seconds_in(text) > 0.0) factor = seconds_in(text);
        if (text == "khz") factor = 1e3;
      }
      const double rate_hz = word.kind == RateWord::Kind::rate ? factor * *value : 1.0 / (factor * *value);
      if (std::isfinite(rate_hz)) return round_15(rate_hz);
    }
    return 0.0;
  }

  /// Also of an axis beside the values: x_values.increment, as Testlab writes it.
  [[nodiscard]] double stated_rate_at(std::size_t group) {
    const auto known = stated_rates_hz_.find(group);
    if (known == stated_rates_hz_.end()) return stated_rates_hz_[group] = find_stated_rate(group);
    return known->second;
  }
  [[nodiscard]] double find_stated_rate(std::size_t group) const {
    if (const double rate_hz = stated_rate(group); rate_hz > 0.0) return rate_hz;
    for (const std::size_t child : children_[group]) {
      const std::string word = plain_word(nodes_[child].key);
      if (nodes_[child].kind == FileNode::Kind::group && (word == "xvalues" || word == "xdata" || word == "x")) {
        if (const double rate_hz = stated_rate(child); rate_hz > 0.0) return rate_hz;
      }
    }
    return 0.0;
  }

  [[nodiscard]] const TreeTimes* times_in(std::size_t group, Eigen::Index samples) const {
    const auto found = std::ranges::find_if(times_, [&](const TreeTimes& times) {
      return times.samples == samples && (nodes_[times.node].parent == group || times.node == group);
    });
    return found == times_.end() ? nullptr : &*found;
  }

  void find_rate(std::size_t place, FileChannel& channel) {
    if (!own_time_.empty()) return;
    for (std::size_t at = place;; at = nodes_[at].parent) {
      const TreeTimes* times = times_in(at, static_cast<Eigen::Index>(channel.samples));
      const double stated_hz = stated_rate_at(at);
      if (times != nullptr) {
        channel.sample_rate_hz = times->rate_hz;
        channel.start = {.is_known = times->fault.empty(), .s = times->start_s};
        channel.fault = times->fault;
        note_contradiction(*times, stated_hz);
        return;
      }
      channel.sample_rate_hz = stated_hz;
      if (stated_hz > 0.0 || at == 0) return;
    }
  }

  void note_contradiction(const TreeTimes& times, double stated_hz) {
    if (stated_hz <= 0.0 || times.rate_hz <= 0.0 || std::abs(stated_hz / times.rate_hz - 1.0) < 1e-3) return;
    std::string note = fmt::format("{}{}: it states {:.6g} Hz beside {}, which runs at {:.6g} Hz and counts",
                                   warning_label, file_, stated_hz, nodes_[times.node].name, times.rate_hz);
    if (std::ranges::find(record_.notes, note) == record_.notes.end()) record_.notes.push_back(std::move(note));
  }

  /// Of each column; empty texts where the file names none.
  [[nodiscard]] std::vector<std::string> names_of(std::size_t place) const {
    const FileNode& node = nodes_[place];
    const std::size_t count = node.columns.size();
    if (count > 1) {
      for (const std::size_t group : {place, node.parent}) {
        const FileNode* names = text_in(group, is_names_word);
        if (names == nullptr) continue;
        std::vector<std::string> out = texts_of(*names, count);
        if (out.size() == count) return out;
      }
    } else {
      const FileNode* label = text_in(place, is_label_word);
      if (label == nullptr && is_values_word(node.key)) label = text_in(node.parent, is_label_word);
      if (label != nullptr && label->texts.size() == 1 && !trimmed(label->texts.front()).empty()) {
        return {std::string(trimmed(label->texts.front()))};
      }
    }
    std::vector<std::string> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(path_of(place, i));
    return out;
  }

  [[nodiscard]] std::string path_of(std::size_t place, std::size_t column) const {
    const FileNode& node = nodes_[place];
    if (node.columns.size() < 2 || node.name.empty()) return node.name;
    const bool matlab = tree_.naming == FileTree::Naming::matlab;
    const std::size_t number = matlab ? column + 1 : column;
    if (matlab) return fmt::format(fmt::runtime(node.by_rows ? "{}({},:)" : "{}(:,{})"), node.name, number);
    return fmt::format(fmt::runtime(node.by_rows ? "{}[{},:]" : "{}[:,{}]"), node.name, number);
  }

  void add_channels(std::size_t place) {
    const FileNode& node = nodes_[place];
    if (!is_signal(node)) return;
    if (!node.fault.empty()) {
      places_.emplace_back(place, 0);
      channels_.push_back({.name = node.name, .samples = 1, .fault = node.fault});
      return;
    }
    FileChannel channel{.samples = static_cast<std::uint64_t>(node.columns.front().size())};
    for (std::size_t i = 0; i < node.columns.size() && channel.fault.empty(); ++i) {
      if (node.columns[i].allFinite()) continue;
      const std::string which = node.columns.size() > 1 ? fmt::format("in column {} ", i + 1) : "";
      channel.fault = fmt::format("{}a value is no finite number", which);
    }
    if (channel.fault.empty()) find_rate(place, channel);
    const std::vector<std::string> names = names_of(place);
    std::vector<std::string> units = units_of(place);
    if (std::ranges::find(in_s_, place) != in_s_.end()) units = {"s"};
    if (units.size() != 1 && units.size() != node.columns.size()) units.clear();
    for (std::size_t i = 0; i < node.columns.size(); ++i) {
      places_.emplace_back(place, i);
      channels_.push_back(channel);
      channels_.back().name = names[i];
      if (!units.empty()) channels_.back().unit = std::string(trimmed(units[units.size() > 1 ? i : 0]));
    }
    if (channels_.size() > most_channels) {
      throw InvalidInput(file_, fmt::format("holds more than {} channels", most_channels),
                         "Does it hold a matrix that is no record? Save the channels alone");
    }
  }

  void name_twins_by_path() {
    std::vector<std::string> names;
    for (const FileChannel& channel : channels_) names.push_back(channel.name);
    std::ranges::sort(names);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto [begin, end] = std::equal_range(names.begin(), names.end(), channels_[i].name);
      if (end - begin > 1) channels_[i].name = path_of(places_[i].first, places_[i].second);
    }
  }

  /// @throws InvalidInput where name and unit of a channel contradict each other; times are in s already
  void require_agreement() const {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const std::string of_name = unit_of_column(channels_[i].name);
      if (time_word(nodes_[places_[i].first].key) > 0.0 || units_agree(channels_[i].unit, of_name)) continue;
      throw InvalidInput(file_, fmt::format("{} is in {} by its name and in {} by the file", channels_[i].name, of_name,
                                            channels_[i].unit));
    }
  }

  /// What may still have to be done to the values.
  void note_scale(std::size_t place) {
    if (place == last_scale_) return;
    last_scale_ = place;
    std::vector<std::size_t> said = children_[place];
    if (is_values_word(nodes_[place].key)) {
      said.insert(said.end(), children_[nodes_[place].parent].begin(), children_[nodes_[place].parent].end());
    }
    for (const std::size_t child : said) {
      const FileNode& node = nodes_[child];
      if (!is_scale_word(node.key) || !is_number(node)) continue;
      const double value = node.columns.front()(0), nothing = plain_word(node.key) == "offset" ? 0.0 : 1.0;
      if (value == nothing) continue;
      record_.notes.push_back(
          fmt::format("{}{}: {} = {:.6g} is not applied to {}: are its values in the unit measured?", warning_label,
                      file_, node.name, value, nodes_[place].name));
    }
  }

  FileTree tree_;
  std::vector<FileNode>& nodes_;
  std::string file_, own_time_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<TreeTimes> times_;
  std::vector<std::size_t> in_s_;                  ///< times that are in s by now
  std::map<std::size_t, double> stated_rates_hz_;  ///< of groups that have been looked at
  std::vector<FileChannel> channels_;
  std::vector<std::pair<std::size_t, std::size_t>> places_;  ///< node and column of each
  std::size_t last_scale_ = none;
  Record record_;
};

}  // namespace

std::size_t FileTree::add(FileNode node) {
  nodes.push_back(std::move(node));
  return nodes.size() - 1;
}

MatrixLie matrix_lie(std::uint64_t rows, std::uint64_t columns) {
  if (columns > rows) return {.by_rows = true, .samples = columns, .columns = rows};
  return {.by_rows = false, .samples = rows, .columns = columns};
}

Record record_of_tree(FileTree tree, const std::filesystem::path& path, const std::string& time) {
  return TreeReader(std::move(tree), path, time).read();
}

}  // namespace robomill::io
