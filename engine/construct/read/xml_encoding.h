// SPDX-License-Identifier: GPL-3.0-or-later
//
// Encodings of XML beside those that expat knows by itself: what the system's iconv knows.
#pragma once

#include <expat.h>

namespace ptin {

/// An unknown encoding handler of expat: encodings of one byte a character, as Windows-1252, and of
/// up to two, as Shift JIS.
/// @param name  As the XML declaration has it.
/// @return  XML_STATUS_OK, or XML_STATUS_ERROR where nobody knows it, or it is of another kind.
int XMLCALL find_xml_encoding(void* ignored, const XML_Char* name, XML_Encoding* to);

}  // namespace ptin
