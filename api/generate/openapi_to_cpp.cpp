// openapi_to_cpp IN.yaml OUT.cpp: turns the contract into the JSON text that the service serves.
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::ordered_json;

// Plain scalars follow YAML's core schema (null, true, 42, 0.5); quoted ones are text.
Json scalar(const YAML::Node& node) {
  const auto& text = node.Scalar();
  if (node.Tag() == "!") return text;
  const Json value = Json::parse(text, nullptr, false);
  return value.is_primitive() && !value.is_discarded() && !value.is_string() ? value : Json(text);
}

Json to_json(const YAML::Node& node) {
  switch (node.Type()) {
  case YAML::NodeType::Map: {
    Json json = Json::object();
    for (const auto& member : node) json[member.first.Scalar()] = to_json(member.second);
    return json;
  }
  case YAML::NodeType::Sequence: {
    Json json = Json::array();
    for (const auto& element : node) json.push_back(to_json(element));
    return json;
  }
  case YAML::NodeType::Scalar:
    return scalar(node);
  case YAML::NodeType::Null:
  case YAML::NodeType::Undefined:
    break;
  }
  return nullptr;
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: openapi_to_cpp IN.yaml OUT.cpp\n";
    return 2;
  }
  try {
    const std::string text = to_json(YAML::LoadFile(argv[1])).dump();
    std::ofstream out(argv[2]);
    out << "#include \"api/openapi.h\"\n\nnamespace orbis::api {\n\nconst std::string_view openapi_json =";
    // Compilers bound the length of one literal; adjacent ones join.
    constexpr std::size_t piece = 8000;
    for (std::size_t i = 0; i < text.size(); i += piece) {
      out << "\n    R\"openapi(" << text.substr(i, piece) << ")openapi\"";
    }
    out << ";\n\n} // namespace orbis::api\n";
    return out.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << argv[1] << ": " << error.what() << '\n';
    return 1;
  }
}
