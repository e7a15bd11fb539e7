// The one place where tinygltf's implementation is compiled.
#include <fstream> // its writer, which is never called, needs it

#define TINYGLTF_IMPLEMENTATION
#include "core/asset/tinygltf_apart.h"
